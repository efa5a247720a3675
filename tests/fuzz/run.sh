#!/usr/bin/env bash
# Runs the fuzzers: run.sh BUILD SECONDS [TARGET...]. With 0 seconds, every file of the corpora once.
# What they learn stays in BUILD/corpus, what they find in BUILD/findings; a finding, once mended,
# becomes a file of tests/fuzz/corpus. An input may take 1 s, five times that with the sanitizers, and 1 GB.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
build=$(realpath "$1")
seconds=$2
shift 2
targets=("$@")
[ ${#targets[@]} -gt 0 ] || targets=($(basename -s _fuzz.cpp "$here"/*_fuzz.cpp))
mkdir -p "$build/findings"
"$here/seeds.py" "$here/../.." "$build/corpus" "${targets[@]}"

fuzz() { # TARGET
  local log=$build/findings/$1.log limits=(-timeout=5 -rss_limit_mb=1024)
  local length=$([ "$1" = wav ] && echo 4096 || echo 16384)
  local folders=("$build/corpus/$1")
  mkdir -p "${folders[0]}"
  [ ! -d "$here/corpus/$1" ] || folders+=("$here/corpus/$1")
  if [ "$seconds" -eq 0 ]; then
    limits+=(-runs=0)
  else
    limits+=(-max_total_time="$seconds" -max_len="$length" -print_final_stats=1 -verbosity=1)
  fi
  [ -f "$build/corpus/$1.dict" ] && limits+=(-dict="$build/corpus/$1.dict")
  local good=1
  "$build/tests/fuzz/fuzz_$1" "${limits[@]}" -artifact_prefix="$build/findings/$1-" \
    "${folders[@]}" >"$log" 2>&1 || good=0
  local runs covered
  runs=$(sed -n 's/^Done \([0-9]*\) runs.*/\1/p;s/^stat::number_of_executed_units: *//p' "$log" | tail -1)
  covered=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$log" | tail -1)
  echo "$1: ${runs:-?} inputs,${covered:+ $covered edges,} $(find "${folders[@]}" -type f | wc -l) files of corpus"
  [ $good -eq 1 ] || { echo "$1: a finding, see $log"; grep -m3 -E 'ERROR|finding:|runtime error' "$log"; return 1; }
}
export -f fuzz
export build here seconds
printf '%s\n' "${targets[@]}" | xargs -P "$(nproc)" -I{} bash -c 'fuzz {}'
