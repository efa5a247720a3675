#!/usr/bin/env bash
# check_benchmark_report.sh WRITE_BENCHMARK_SAMPLE: opens the report of a made-up benchmark of 10^5
# tasks in headless Chromium from file:// and checks its size, that every chart is drawn without an
# error and without a look at the network, that the filters work and a click gives the command that
# replays a task. Exit code 77: there is no browser.
set -euo pipefail
write_sample=$1
browser=$(command -v chromium || command -v chromium-browser || true)
if [ -z "$browser" ]; then
  echo "no chromium: the page is not looked at (install the packages marked test in packages.txt)"
  exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$write_sample" "$folder/out" 321
page=$folder/out/report.html

probe=$folder/out/probe.html
cp "$page" "$probe"
cat >>"$probe" <<'JS'
<script>
(function probe() {
  if (window.__modcal_ready === null) { setTimeout(probe, 20); return; }
  var seen = document.documentElement.dataset;
  var all = function (selector) { return Array.prototype.slice.call(document.querySelectorAll(selector)); };
  var chart = document.querySelector('#data_profile .chart');
  var picture = function () { return chart.querySelector('canvas').toDataURL(); };
  var visible = function (list) { return list.filter(function (e) { return e.offsetParent !== null; }).length; };
  seen.facets = all('#filters select, #filters summary').length;
  seen.rows = visible(all('#benchmark tbody tr'));
  var start = picture();
  // One noise level: other curves, a part of the rows.
  var select = document.querySelector('#filters select');
  select.value = 'noise 5 %';
  select.dispatchEvent(new Event('change'));
  seen.oneNoise = [picture() !== start, visible(all('#benchmark tbody tr'))].join();
  select.value = 'all';
  select.dispatchEvent(new Event('change'));
  seen.back = [picture() === start, visible(all('#benchmark tbody tr'))].join();
  // One objective away: its panels and rows go.
  var box = all('#filters input[name=objective]')[0];
  box.click();
  seen.oneObjectiveLess = [visible(all('#data_profile .chart')), visible(all('#success tbody tr'))].join();
  box.click();
  // One optimizer away: its entry in the legend goes, too.
  var search = all('#filters input[name=optimizer]')[0];
  var keys = visible(all('#data_profile .key'));
  search.click();
  seen.oneOptimizerLess = [keys - visible(all('#data_profile .key')), visible(all('#success tbody tr'))].join();
  search.click();
  seen.restored = picture() === start;
  // The command behind a cell of the map and behind a point.
  var bar = document.getElementById('replay');
  seen.barFirst = bar.hidden;
  document.querySelector('#success td[data-task]').click();
  seen.cellCommand = bar.querySelector('code').textContent.replace(/[0-9]+$/, 'N');
  bar.querySelector('.close').click();
  chart.focus();
  chart.dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowRight', bubbles: true}));
  chart.dispatchEvent(new KeyboardEvent('keydown', {key: 'Enter', bubbles: true}));
  seen.keyCommand = bar.querySelector('code').textContent.replace(/[0-9]+$/, 'N');
  bar.querySelector('.close').click();
  var points = document.querySelector('#work_precision .chart');
  points.scrollIntoView();
  var box_ = points.getBoundingClientRect();
  var canvas = points.querySelector('canvas:last-of-type');
  for (var x = 0.1; x < 1 && bar.hidden; x += 0.02) {
    for (var y = 0.05; y < 0.9 && bar.hidden; y += 0.05) {
      canvas.dispatchEvent(new MouseEvent('click', {bubbles: true, clientX: box_.left + x * box_.width,
                                                    clientY: box_.top + y * box_.height}));
    }
  }
  seen.pointCommand = bar.querySelector('code').textContent.replace(/[0-9]+$/, 'N');
  seen.requests = performance.getEntriesByType('resource').filter(function (e) {
    return e.name.indexOf('data:') !== 0;
  }).length;
  var players = all('audio');
  var waited = 0;
  (function sounds() {
    if (players.some(function (p) { return !(p.duration > 0); }) && waited++ < 200) { setTimeout(sounds, 20); return; }
    seen.sounds = players.map(function (p) { return p.duration.toFixed(2); }).join();
  })();
})();
</script>
JS

browse() {
  "$browser" --headless --no-sandbox --disable-gpu --disable-quic --no-first-run \
    --disable-background-networking --disable-component-update --disable-sync \
    --user-data-dir="$folder/profile$RANDOM" --enable-logging=stderr --virtual-time-budget=20000 \
    --window-size=1400,1000 --dump-dom "file://$1" 2>"$folder/log"
}
failures=0
expect() {  # expect WHAT ACTUAL EXPECTED
  if [ "$2" != "$3" ]; then
    echo "$1: \"$2\" instead of \"$3\""
    failures=$((failures + 1))
  fi
}
dom=$(browse "$probe")
seen() { grep -o "<html [^>]*>" <<<"$dom" | grep -o " data-$1=\"[^\"]*\"" | cut -d'"' -f2; }
charts=$(grep -o '<div class="chart[" ]' "$page" | wc -l)
size=$(stat -c %s "$page")
[ "$size" -le 2000000 ] || { echo "the page has $size bytes"; failures=1; }
expect "charts in the page" "$charts" 18
expect "charts drawn" "$(seen charts)" "$charts"
expect "errors" "$(seen errors)" 0
expect "console" "$(grep CONSOLE "$folder/log" || true)" ""
expect "facets" "$(seen facets)" 3
expect "rows" "$(seen rows)" 312
expect "one noise level (picture changed, rows)" "$(seen one-noise)" "true,39"
expect "all again (picture as before, rows)" "$(seen back)" "true,312"
expect "an objective less (panels, rows)" "$(seen one-objective-less)" "2,26"
expect "an optimizer less (legend, rows)" "$(seen one-optimizer-less)" "3,36"
expect "all filters undone" "$(seen restored)" true
expect "no command at first" "$(seen bar-first)" true
expect "command of a cell" "$(seen cell-command)" "modcal replay out/made-up N"
expect "command by keyboard" "$(seen key-command)" "modcal replay out/made-up N"
expect "command of a point" "$(seen point-command)" "modcal replay out/made-up N"
expect "requests" "$(seen requests)" 0
expect "sounds" "$(seen sounds)" "0.50,0.50"
[ "$failures" -eq 0 ] || { sed -n 1,20p "$folder/log"; exit 1; }
echo "$charts charts of 10^5 tasks in $size bytes, filtered and replayed without an error"
