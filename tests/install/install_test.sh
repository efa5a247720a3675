#!/usr/bin/env bash
# Installs what is built, moves it and uses it as a stranger would: the program without the source tree,
# every component by itself, examples/ as a project of its own by find_package and its tests, one program
# by pkg-config. Nothing of modcal's is compiled. install_test.sh ROOT BUILD CMAKE COMPILER EIGEN
set -euo pipefail
root=$(cd "${1:?usage: install_test.sh ROOT BUILD CMAKE COMPILER EIGEN}" && pwd)
build=$(cd "$2" && pwd) cmake=$3 compiler=$4 eigen=$5
unset CXXFLAGS
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() { echo "$*"; exit 1; }
quietly() { "$@" >"$work/log" 2>&1 || fail "$(cat "$work/log")"; }
foreign_flags() { grep -oE -- '(^| )-(W|f|m|O)[^ ]+'; } # a user's build without a type has none
foreign_flags <<<'c++ -fcx-limited-range' >/dev/null || fail "self-check: a flag goes unnoticed"

quietly "$cmake" --install "$build" --prefix "$work/there"
mv "$work/there" "$work/prefix" # an installed package can be moved
prefix=$work/prefix
for place in "$root" "$build" "$work/there"; do # text only: debug information holds paths
  if found=$(grep -rIlF "$place" "$prefix"); then fail "$place stands in $found"; fi
done
if grep -qF "$root/configs" "$prefix/bin/modcal"; then fail "modcal knows $root/configs"; fi
quietly "$prefix/bin/modcal" reproduce fig02 --out "$work/fig02"
# The public headers are there with all that they include.
(cd "$root" && printf '#include "%s"\n' lib{sim,inverse,calib}/*.hpp) >"$work/all.cpp"
quietly "$compiler" -std=c++20 -fsyntax-only -I"$prefix/include/modcal" -isystem "$eigen" "$work/all.cpp"

quietly "$cmake" -S "$root/examples" -B "$work/examples" -DCMAKE_PREFIX_PATH="$prefix" \
  -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DCMAKE_CXX_COMPILER="$compiler"
if foreign_flags <"$work/examples/compile_commands.json"; then fail "a user gets flags of modcal's"; fi
quietly "$cmake" --build "$work/examples"
(cd "$work/examples" && quietly "${cmake%cmake}ctest" --output-on-failure --no-tests=error)

# The component of inversions is enough for one.
mkdir "$work/alone"
cat >"$work/alone/CMakeLists.txt" <<'EOF'
cmake_minimum_required(VERSION 3.25)
project(alone LANGUAGES CXX)
find_package(modcal REQUIRED COMPONENTS inverse io)
add_executable(invert_record ${EXAMPLES}/invert_record.cpp)
target_link_libraries(invert_record PRIVATE modcal::inverse modcal::io)
EOF
quietly "$cmake" -S "$work/alone" -B "$work/alone/build" -DCMAKE_PREFIX_PATH="$prefix" \
  -DCMAKE_CXX_COMPILER="$compiler" -DEXAMPLES="$root/examples"
quietly "$cmake" --build "$work/alone/build"
"$work/alone/build/invert_record" "$work/examples/stroke.wav" | grep -q '^force from both reactions' ||
  fail "a program of the component inverse does not run"

# A component brings what it stands on and nothing else; what is asked for and not there is said.
cat >"$work/CMakeLists.txt" <<'EOF'
cmake_minimum_required(VERSION 3.25)
project(asks LANGUAGES CXX)
foreach(component IN LISTS WANTED)
  find_package(modcal 0.1 REQUIRED COMPONENTS ${component})
  get_property(targets DIRECTORY PROPERTY IMPORTED_TARGETS)
  list(FILTER targets INCLUDE REGEX ^modcal::)
  list(SORT targets)
  file(APPEND ${CMAKE_BINARY_DIR}/brings "${component}: ${targets}\n")
endforeach()
find_package(modcal REQUIRED COMPONENTS ${ALL})
EOF
asks() { # options
  rm -rf "$work/asks"
  "$cmake" -S "$work" -B "$work/asks" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_CXX_COMPILER="$compiler" \
    "$@" >"$work/log" 2>&1
}
asks -DWANTED="model;io;sim;inverse;calib" || fail "$(cat "$work/log")"
diff "$work/asks/brings" - <<'EOF' || fail "a component brings other targets"
model: modcal::model
io: modcal::io;modcal::model
sim: modcal::io;modcal::model;modcal::sim
inverse: modcal::identify;modcal::inverse;modcal::io;modcal::model;modcal::pluck;modcal::sim
calib: modcal::calib;modcal::identify;modcal::inverse;modcal::io;modcal::model;modcal::pluck;modcal::sim
EOF
if asks -DWANTED=sound; then fail "find_package(modcal COMPONENTS sound) succeeds"; fi
grep -q 'no component "sound"' "$work/log" || fail "$(cat "$work/log")"
if asks -DWANTED=calib -DCMAKE_DISABLE_FIND_PACKAGE_Ceres=ON; then
  fail "find_package(modcal COMPONENTS calib) succeeds without Ceres"
fi
grep -q 'lacks: Ceres' "$work/log" || fail "$(cat "$work/log")"
asks -DWANTED=sim -DALL=sim -DCMAKE_DISABLE_FIND_PACKAGE_Ceres=ON || fail "$(cat "$work/log")"

packages=$(find "$prefix" -name pkgconfig)
for component in model io sim inverse calib; do
  PKG_CONFIG_PATH=$packages quietly pkg-config --exists --print-errors modcal-$component
done
flags=$(PKG_CONFIG_PATH=$packages pkg-config --cflags --libs modcal-calib)
if foreign_flags <<<"$flags"; then fail "pkg-config gives flags of modcal's"; fi
# shellcheck disable=SC2086
"$compiler" -std=c++20 "$root/examples/own_optimizer.cpp" $flags -o "$work/own_optimizer"
"$work/own_optimizer" | grep -q '^x_c = 0.0' || fail "a program linked by pkg-config does not run"
