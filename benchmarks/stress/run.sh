#!/bin/sh
# Simulates the stability map and writes docs/stability.md and docs/stability.svg: run.sh BUILD_FOLDER
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
status=0
"$root/$1/benchmarks/stability_map" "$folder" > "$folder/table.md" || status=$?
# 1: the whole map, with a wrong cell in it. One that was stopped is no map.
[ "$status" -le 1 ] || exit "$status"
cat "$root/benchmarks/stress/preface.md" "$folder/table.md" > "$root/docs/stability.md"
gnuplot -e "folder='$folder'; out='$root/docs/stability.svg'" "$root/benchmarks/stress/stability_map.gp"
cat "$folder/table.md"
exit "$status"
