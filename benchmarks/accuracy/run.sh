#!/usr/bin/env bash
# Accuracy of the simulators, and of regularizers with their parameter choices:
# run.sh BUILD_DIRECTORY OUTPUT_DIRECTORY [--quick] writes tables (CSV) and figures (SVG) of error
# against run time, of the growth of small errors, and of random scenes.
set -euo pipefail
build=${1:?usage: run.sh BUILD_DIRECTORY OUTPUT_DIRECTORY [--quick]}
out=${2:?usage: run.sh BUILD_DIRECTORY OUTPUT_DIRECTORY [--quick]}
quick=${3:-}
here=$(dirname "$0")
mkdir -p "$out"

for scene in paper stiff thermal; do
  "$build/benchmarks/work_precision" "$scene" $quick >"$out/work_precision_$scene.csv"
  gnuplot -e "table='$out/work_precision_$scene.csv'; figure='$out/work_precision_$scene.svg'; name='$scene'" \
    "$here/work_precision.gp"
done
"$build/benchmarks/regularizer_error" $quick >"$out/regularizer_error.csv"
gnuplot -e "table='$out/regularizer_error.csv'; figure='$out/regularizer_error.svg'" "$here/regularizer_error.gp"
"$build/benchmarks/perturbation_growth" >"$out/perturbation_growth.csv"
"$build/benchmarks/random_scenes" | tee "$out/random_scenes.txt"
echo "tables and figures: $out"
