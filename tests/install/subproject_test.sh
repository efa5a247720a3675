#!/usr/bin/env bash
# modcal within another project, by add_subdirectory and by FetchContent, on a machine without
# GoogleTest, Google Benchmark and what the program alone needs. Both ways are configured; of the first
# the user's file and one of the library are compiled, and the command lines of all other files are
# read (building all that the user links takes two minutes). subproject_test.sh ROOT CMAKE COMPILER
set -euo pipefail
root=$(cd "${1:?usage: subproject_test.sh ROOT CMAKE COMPILER}" && pwd)
cmake=$2 compiler=$3
unset CXXFLAGS
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "$*"; exit 1; }
quietly() { "$@" >"$work/log" 2>&1 || fail "$(cat "$work/log")"; }

configure() { # name, further options
  quietly "$cmake" -S "$root/examples/as_subdirectory" -B "$work/$1" -G Ninja \
    -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS_RELEASE=-O1 \
    -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_EXPORT_COMPILE_COMMANDS=ON "${@:2}" \
    -DCMAKE_DISABLE_FIND_PACKAGE_GTest=ON -DCMAKE_DISABLE_FIND_PACKAGE_benchmark=ON \
    -DCMAKE_DISABLE_FIND_PACKAGE_CLI11=ON -DCMAKE_DISABLE_FIND_PACKAGE_yaml-cpp=ON \
    -DCMAKE_DISABLE_FIND_PACKAGE_MPI=ON
}
configure fetched -DFETCH=ON
configure added
for way in fetched added; do
  commands=$work/$way/compile_commands.json
  user=$(grep -E '"command".*examples/simulate_stroke.cpp' "$commands")
  if grep -oE -- ' -(W|f|m)[^ ]+' <<<"$user"; then fail "flags of modcal's in a user's command line"; fi
  grep -qE -- '-std=(c|gnu)\+\+20' <<<"$user" || fail "no C++20 for the user: $user"
  grep -q -- '-fcx-limited-range .*libcalib/' "$commands" || fail "modcal has lost its flags"
  if grep -q '/tests/\|/benchmarks/\|/experiments/' "$commands"; then
    fail "more than the libraries would be built"
  fi
done
quietly "$cmake" --build "$work/added" --target "$root/libsim/model/string_model.cpp^" \
  "$root/examples/simulate_stroke.cpp^"
for file in string_model simulate_stroke; do
  find "$work/added" -name "$file.cpp.o" | grep -q . || fail "$file is not compiled"
done
