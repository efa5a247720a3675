#!/usr/bin/env bash
# check_opening.sh MODCAL EXAMPLES: the report of a calibration of the example record has at most 2 MB, and what is in
# sight is drawn by the end of its script. Prints when that was; a second is asked for. Exit code 77: there is no browser.
set -euo pipefail
. "$(dirname "$0")/browser.sh"
find_browser
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
"$1" new calibrate "$2/bowed_violin_d.csv" --length "0.33 m" --out mine.yaml >/dev/null
"$1" run mine.yaml --out out --quiet >/dev/null
size=$(stat -c %s out/report.html)
[ "$size" -le 2000000 ] || { echo "the page has $size bytes"; exit 1; }

# The clock of the page, from when it was asked for to the end of its script.
cat out/report.html - >probe.html <<'JS'
<script>
document.documentElement.dataset.opened =
    window.__modcal_ready > 0 ? Math.ceil(performance.now()) : 'not drawn yet';
</script>
JS
dom=$("$browser" --headless --no-sandbox --disable-gpu --no-first-run --disable-background-networking \
  --user-data-dir="$folder/profile" --window-size=1400,1000 --dump-dom "file://$folder/probe.html" 2>/dev/null)
opened=$(seen opened)
echo "opened after $opened ms"
[[ $opened =~ ^[0-9]+$ ]]
