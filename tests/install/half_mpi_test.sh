#!/usr/bin/env bash
# An MPI of which only the program mpicxx is installed (Debian's openmpi-bin without libopenmpi-dev)
# must not end the configuration. half_mpi_test.sh ROOT CMAKE
set -euo pipefail
root=$(cd "${1:?usage: half_mpi_test.sh ROOT CMAKE}" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

mkdir "$work/bin"
cat >"$work/bin/mpicxx" <<'EOF'
#!/bin/sh
# Answers as Open MPI's does and names folders that are not there.
case "$*" in
*-showme:compile*) echo "-I/nowhere/openmpi/include -pthread" ;;
*-showme:link*) echo "-pthread -L/nowhere/openmpi/lib -lmpi_cxx -lmpi" ;;
*-showme*) echo "c++ -I/nowhere/openmpi/include -pthread -L/nowhere/openmpi/lib -lmpi_cxx -lmpi" ;;
*) exec c++ -I/nowhere/openmpi/include -pthread -L/nowhere/openmpi/lib "$@" -lmpi_cxx -lmpi ;;
esac
EOF
chmod +x "$work/bin/mpicxx"
configure() {
  mkdir -p "$work/$1"
  printf 'cmake_minimum_required(VERSION 3.25)\nproject(half LANGUAGES CXX)\n%s\n' "$2" \
    >"$work/$1/CMakeLists.txt"
  PATH="$work/bin:$PATH" "${cmake:=cmake}" -S "$work/$1" -B "$work/$1/build" >"$work/$1.log" 2>&1
}
cmake=${2:-cmake}

if configure plain 'find_package(MPI QUIET COMPONENTS CXX)'; then
  echo "self-check: this FindMPI takes such an MPI; the test shows nothing"
fi
if ! configure ours "include($root/cmake/find_mpi.cmake)
if(MPI_CXX_FOUND)
  message(FATAL_ERROR \"such an MPI counts as found\")
endif()"; then
  cat "$work/ours.log"
  exit 1
fi
grep -q 'modcal-mpi is not built' "$work/ours.log"
