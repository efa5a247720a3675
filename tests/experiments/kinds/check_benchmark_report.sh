#!/usr/bin/env bash
# check_benchmark_report.sh WRITE_BENCHMARK_SAMPLE: opens the report of a made-up benchmark of 10^5
# tasks in headless Chromium from file:// and checks its size, that every chart is drawn without an
# error and without a look at the network, that the filters work and a click gives the command that
# replays a task. Exit code 77: there is no browser.
set -euo pipefail
. "$(dirname "$0")/../report/browser.sh"
write_sample=$1
find_browser
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

browse "$probe" 20000
size=$(stat -c %s "$page")
[ "$size" -le 2000000 ] || { echo "the page has $size bytes"; failures=1; }
expect_charts "$page" 18
expect "facets" "$(seen facets)" 3
expect "rows" "$(seen rows)" 312
expect "one noise level (picture changed, rows)" "$(seen one-noise)" "true,39"
expect "all again (picture as before, rows)" "$(seen back)" "true,312"
expect "an objective less (panels, rows)" "$(seen one-objective-less)" "2,26"
expect "an optimizer less (legend, rows)" "$(seen one-optimizer-less)" "1,36"
expect "all filters undone" "$(seen restored)" true
expect "no command at first" "$(seen bar-first)" true
expect "command of a cell" "$(seen cell-command)" "modcal replay out/made-up N"
expect "command by keyboard" "$(seen key-command)" "modcal replay out/made-up N"
expect "command of a point" "$(seen point-command)" "modcal replay out/made-up N"
expect "requests" "$(seen requests)" 0
expect "sounds" "$(seen sounds)" "0.50,0.50"
give_verdict
echo "$charts charts of 10^5 tasks in $size bytes, filtered and replayed without an error"
