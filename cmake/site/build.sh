#!/usr/bin/env bash
# README, docs/ and the C++ reference as one site that needs no network: build.sh OUT leaves it in OUT/html.
# Exit code 77: a program that it needs is missing.
set -euo pipefail
root=$(cd "$(dirname "$0")/../.." && pwd)
mkdir -p "${1:?usage: build.sh OUT}"
out=$(cd "$1" && pwd)
for program in mkdocs doxygen cmake; do
  command -v "$program" >/dev/null || { echo "build.sh: $program is missing; \"make docs\" installs it" >&2; exit 77; }
done

# Pages stand to each other as in the tree, so that links lead where they lead there.
rm -rf "$out"/{source,include,html}
mkdir -p "$out"/source/{api,benchmarks}
ln -s "$root"/{README.md,CHANGELOG.md,docs} "$out/source"
ln -s "$root"/benchmarks/{README.md,measured} "$out/source/benchmarks"
ln -sfn "$root"/cmake/site/{mkdocs.yml,theme} "$out"
ln -sfn "$root/python" "$out/package"
ln -s "$root/cmake/site/python_reference.md" "$out/source"

cmake -D MODCAL_SOURCE_DIR="$root" -D CMAKE_INSTALL_PREFIX="$out" -D MODCAL_INCLUDE_DIR=include \
  -P "$root/cmake/install_headers.cmake" >/dev/null
{
  cat "$root/cmake/site/Doxyfile"
  printf '%s = "%s"\n' INPUT "$out/include" STRIP_FROM_PATH "$out/include" OUTPUT_DIRECTORY "$out/source/api"
  printf 'INPUT += "%s"\n' "$root/cmake/site/mainpage.dox"
} | doxygen -
mkdocs build --strict --config-file "$out/mkdocs.yml" --site-dir "$out/html"
