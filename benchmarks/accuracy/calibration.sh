#!/usr/bin/env bash
# Calibration: calibration.sh BUILD_DIRECTORY OUTPUT_DIRECTORY writes work_precision.svg with its table,
# and objective_bias.svg.
set -euo pipefail
build=${1:?usage: calibration.sh BUILD_DIRECTORY OUTPUT_DIRECTORY}
out=${2:?usage: calibration.sh BUILD_DIRECTORY OUTPUT_DIRECTORY}
here=$(dirname "$0")
mkdir -p "$out"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

"$build/benchmarks/calibration_work_precision" >"$scratch/work_precision.csv"
gnuplot -e "table='$scratch/work_precision.csv'; figure='$out/work_precision.svg'" \
  "$here/calibration_work_precision.gp" 2>/dev/null
"$here/calibration_table.py" "$scratch/work_precision.csv" | tee "$out/work_precision.md"
for what in frequency contact offsets; do
  "$build/benchmarks/objective_bias" "$what" >"$scratch/$what.csv"
done
gnuplot -e "folder='$scratch'; figure='$out/objective_bias.svg'" "$here/objective_bias.gp"
echo "figures and table: $out"
