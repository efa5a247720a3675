#!/usr/bin/env bash
# Measures what benchmarks/README.md and benchmarks/measured state: run.sh BUILD_DIRECTORY. Medians of several repetitions.
set -euo pipefail
build=${1:?usage: run.sh BUILD_DIRECTORY}
here=$(dirname "$0")
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

echo "machine: $(grep -m1 'model name' /proc/cpuinfo | cut -d: -f2 | xargs), $(nproc) threads, load $(cut -d' ' -f1 /proc/loadavg)"
for kernel in simulator inversion spectral_peak calibration_bound; do
  echo "== $kernel"
  "$build/benchmarks/${kernel}_benchmark" --benchmark_repetitions=5 \
    --benchmark_report_aggregates_only=true --benchmark_display_aggregates_only=true 2>/dev/null |
    grep -E '_median|_cv|^Benchmark'
done
echo "== growth of the simulators' time with record and modes"
"$build/benchmarks/simulator_scaling"
echo "== the spectral-peak search in NumPy, on the same data"
"$build/benchmarks/spectral_peak_benchmark" --write_case="$out/case.bin"
/usr/bin/python3 "$here/peers/spectral_peak_search.py" "$out/case.bin" 5
echo "== calibration to the bound in NumPy and SciPy, on the same data"
"$build/benchmarks/calibration_peer" --write_case="$out/calibration.bin"
/usr/bin/python3 "$here/peers/joint_likelihood_fit.py" "$out/calibration.bin" 3
echo "== the joint inversion in NumPy and SciPy, on the same data"
"$build/benchmarks/inversion_benchmark" --write_case="$out/joint.bin"
/usr/bin/python3 "$here/peers/joint_inversion.py" "$out/joint.bin" 9
echo "== ensembles over threads"
"$build/benchmarks/ensemble_benchmark"
echo "== what skipping saves"
"$build/benchmarks/skipping_benchmark"
echo "== lists of tasks"
"$build/benchmarks/task_list_benchmark"
echo "== whole commands"
for config in table1 fig14 fig10; do
  "$here/whole_process.py" -- "$build/modcal" run "$here/../configs/paper/$config.yaml" --out "$out/$config"
done
"$here/whole_process.py" -n 3 -- "$build/modcal" reproduce paper --out "$out/paper"
