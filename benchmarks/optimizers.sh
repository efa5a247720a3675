#!/usr/bin/env bash
# Runs configs/benchmark/optimizers.yaml (or goes on with it), renders its report into
# docs/benchmark.png and puts its conclusion into docs/choosing.md: optimizers.sh BUILD_DIRECTORY [OUT].
# OUT is relative to the project, so that the picture shows a command that works everywhere.
set -euo pipefail
build=$(cd "${1:?usage: optimizers.sh BUILD_DIRECTORY [OUT]}" && pwd)
root=$(cd "$(dirname "$0")/.." && pwd)
out=${2:-out/optimizers}
profile=$(mktemp -d)
trap 'rm -rf "$profile"' EXIT

cd "$root"
start=$SECONDS
"$build/modcal" run configs/benchmark/optimizers.yaml --out "$out" >"$profile/conclusion" || [ $? -eq 4 ]
echo "finished after $((SECONDS - start)) s"
cat "$profile/conclusion"

chromium --headless --no-sandbox --disable-gpu --no-first-run --disable-background-networking \
  --hide-scrollbars --user-data-dir="$profile/chromium" --virtual-time-budget=20000 \
  --force-device-scale-factor=0.65 --window-size=1290,"${HEIGHT:-1500}" --screenshot=docs/benchmark.png \
  "file://$(realpath "$out")/report.html" 2>/dev/null
stat -c '%n: %s bytes' docs/benchmark.png

awk -v text="$profile/conclusion" '
  /<!-- conclusion of the benchmark -->/ { print; print ""; while ((getline line < text) > 0) print "* " line; print ""; skip = 1; next }
  /<!-- end of the conclusion -->/ { skip = 0 }
  !skip { print }' docs/choosing.md >"$profile/choosing.md"
cp "$profile/choosing.md" docs/choosing.md
