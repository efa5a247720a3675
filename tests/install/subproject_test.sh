#!/usr/bin/env bash
# modcal within another project, by add_subdirectory and by FetchContent, on a machine without
# GoogleTest, Google Benchmark and what the program alone needs. subproject_test.sh ROOT CMAKE COMPILER
set -euo pipefail
root=$(cd "${1:?usage: subproject_test.sh ROOT CMAKE COMPILER}" && pwd)
cmake=$2 compiler=$3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "$*"; exit 1; }

configure() { # name, further options
  "$cmake" -S "$root/examples/as_subdirectory" -B "$work/$1" -G Ninja -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_CXX_FLAGS_RELEASE=-O1 \
    -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_EXPORT_COMPILE_COMMANDS=ON "${@:2}" \
    -DCMAKE_DISABLE_FIND_PACKAGE_GTest=ON -DCMAKE_DISABLE_FIND_PACKAGE_benchmark=ON \
    -DCMAKE_DISABLE_FIND_PACKAGE_CLI11=ON -DCMAKE_DISABLE_FIND_PACKAGE_yaml-cpp=ON \
    -DCMAKE_DISABLE_FIND_PACKAGE_MPI=ON >"$work/log" 2>&1 || fail "$(cat "$work/log")"
}
configure fetched -DFETCH=ON
configure added
user=$(grep -E '"command".*examples/simulate_stroke.cpp' "$work/added/compile_commands.json")
if grep -oE -- ' -(W|f)[^ ]+' <<<"$user"; then fail "flags of modcal's in a user's command line"; fi
grep -qE -- '-std=(c|gnu)\+\+20' <<<"$user" || fail "no C++20 for the user: $user"
if grep -q '/tests/\|/benchmarks/\|/experiments/' "$work/added/compile_commands.json"; then
  fail "more than the libraries would be built"
fi
"$cmake" --build "$work/added" >"$work/log" 2>&1 || fail "$(cat "$work/log")"
"$work/added/simulate_stroke" "$work/stroke.wav" | grep -q '^51200 samples' ||
  fail "the program built beside modcal does not run"
