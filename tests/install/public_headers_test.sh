#!/usr/bin/env bash
# What stands at the root of a library is its public interface: every public header compiles by itself,
# with the include paths that a user has. What it may include is a rule of tests/rules.
# public_headers_test.sh ROOT COMPILER EIGEN
set -euo pipefail
root=$(cd "${1:?usage: public_headers_test.sh ROOT COMPILER EIGEN}" && pwd)
compiler=${2:-c++} eigen=${3:-/usr/include/eigen3}
compiles() { "$compiler" -std=c++20 -fsyntax-only -x c++ -I"$root" -isystem "$eigen" -; }

if compiles <<<'std::vector<double> planted;' 2>/dev/null; then
  echo "self-check: a missing include goes unnoticed"
  exit 1
fi
failed=0 seen=0
for header in "$root"/lib{sim,inverse,calib}/*.hpp; do
  seen=$((seen + 1))
  compiles <<<"#include \"${header#"$root"/}\"" || { echo "$header does not compile by itself"; failed=1; }
done
[ "$seen" -ge 3 ] || { echo "no public headers below $root"; exit 1; }
exit $failed
