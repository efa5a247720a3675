#!/usr/bin/env bash
# Installs what is built and uses it as a stranger would: examples/ as a project of its own by
# find_package, one program by pkg-config. install_test.sh ROOT BUILD CMAKE COMPILER
set -euo pipefail
root=$(cd "${1:?usage: install_test.sh ROOT BUILD CMAKE COMPILER}" && pwd)
build=$(cd "$2" && pwd) cmake=$3 compiler=$4
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "$*"; exit 1; }

"$cmake" --install "$build" --prefix "$work/there" >"$work/log" || fail "$(cat "$work/log")"
mv "$work/there" "$work/prefix" # an installed package can be moved
prefix=$work/prefix
for place in "$root" "$build" "$work/there"; do
  if found=$(grep -rlF "$place" "$prefix"); then fail "$place stands in $found"; fi
done
[ -x "$prefix/bin/modcal" ] || fail "no program in $prefix/bin"
find "$prefix/include" -name '*.hpp' | grep -q . || fail "no headers in $prefix/include"

"$cmake" -S "$root/examples" -B "$work/examples" -DCMAKE_PREFIX_PATH="$prefix" \
  -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DCMAKE_CXX_COMPILER="$compiler" >"$work/log" 2>&1 ||
  fail "$(cat "$work/log")"
if grep -oE -- ' -(W|f|O)[^ ]+' "$work/examples/compile_commands.json"; then
  fail "flags of modcal's in a user's command line"
fi
"$cmake" --build "$work/examples" >"$work/log" 2>&1 || fail "$(cat "$work/log")"
(cd "$work/examples" && "${cmake%cmake}ctest" --output-on-failure >"$work/log") || fail "$(cat "$work/log")"

# What is asked for and not there is said.
cat >"$work/CMakeLists.txt" <<'EOF'
cmake_minimum_required(VERSION 3.25)
project(asks LANGUAGES CXX)
find_package(modcal REQUIRED COMPONENTS ${WANTED})
EOF
if "$cmake" -S "$work" -B "$work/asks" -DWANTED=sound -DCMAKE_PREFIX_PATH="$prefix" >"$work/log" 2>&1; then
  fail "find_package(modcal COMPONENTS sound) succeeds"
fi
grep -q 'no component "sound"' "$work/log" || fail "$(cat "$work/log")"
rm -r "$work/asks"
if "$cmake" -S "$work" -B "$work/asks" -DWANTED=calib -DCMAKE_PREFIX_PATH="$prefix" \
  -DCMAKE_DISABLE_FIND_PACKAGE_Ceres=ON >"$work/log" 2>&1; then
  fail "find_package(modcal COMPONENTS calib) succeeds without Ceres"
fi
grep -q 'lacks: Ceres' "$work/log" || fail "$(cat "$work/log")"
rm -r "$work/asks"
"$cmake" -S "$work" -B "$work/asks" -DWANTED=sim -DCMAKE_PREFIX_PATH="$prefix" \
  -DCMAKE_DISABLE_FIND_PACKAGE_Ceres=ON >"$work/log" 2>&1 || fail "$(cat "$work/log")"

packages=$(find "$prefix" -name pkgconfig)
flags=$(PKG_CONFIG_PATH=$packages pkg-config --cflags --libs modcal-calib)
# shellcheck disable=SC2086
"$compiler" -std=c++20 "$root/examples/own_optimizer.cpp" $flags -o "$work/own_optimizer"
"$work/own_optimizer" | grep -q '^x_c = 0.0' || fail "a program linked by pkg-config does not run"
