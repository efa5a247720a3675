#!/usr/bin/env bash
# check_report.sh WRITE_SAMPLE: opens the sample report in headless Chromium from file:// and checks
# that every chart is drawn without an error, and that cursor, zoom and reset act on linked charts.
# Exit code 77: there is no browser.
set -euo pipefail
. "$(dirname "$0")/browser.sh"
write_sample=$1
find_browser
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$write_sample" "$folder/out" >/dev/null
page=$folder/out/report.html

# The report itself, followed by a script that uses it and writes what it saw into the root element.
probe=$folder/out/probe.html
cp "$page" "$probe"
cat >>"$probe" <<'JS'
<script>
(function probe() {
  var seen = document.documentElement.dataset;
  var all = document.querySelectorAll('.chart').length;
  var fold = document.querySelector('section > details');
  if (window.__modcal_ready === null) { setTimeout(probe, 20); return; }
  if (!fold.open && !seen.foldedCharts) {
    seen.foldedCharts = [window.__modcal_ready, fold.querySelectorAll('canvas').length].join();
    fold.open = true;
  }
  if (window.__modcal_ready < all) { setTimeout(probe, 20); return; }
  var panels = document.querySelectorAll('#fig8 .chart');
  var other = document.querySelector('#noise .chart');
  var picture = function (chart) { return chart.querySelector('canvas').toDataURL(); };
  var press = function (key) {
    panels[0].dispatchEvent(new KeyboardEvent('keydown', {key: key, bubbles: true}));
  };
  var values = function (chart) { return chart.parentNode.querySelector('.values').textContent; };
  seen.painted = Array.prototype.filter.call(document.querySelectorAll('.chart'), function (chart) {
    var canvas = chart.querySelector('canvas');
    var pixels = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
    for (var i = 0, painted = 0; i < pixels.length; i += 4) {
      if (pixels[i + 3] > 200 && Math.max(pixels[i], pixels[i + 1], pixels[i + 2]) -
          Math.min(pixels[i], pixels[i + 1], pixels[i + 2]) > 60) painted++;
    }
    return painted > 50;
  }).length;
  var start = [picture(panels[0]), picture(panels[3]), picture(other)];
  press('ArrowRight');
  press('ArrowRight');
  seen.cursor = values(panels[0]);
  seen.linkedCursor = values(panels[3]);
  seen.otherCursor = values(other);
  press('+');
  seen.zoomed = [picture(panels[0]) !== start[0], picture(panels[3]) !== start[1],
                 picture(other) !== start[2],
                 document.querySelector('#fig8 .reset').hidden].join();
  document.querySelector('#fig8 .reset').click();
  press('Escape');
  seen.reset = [picture(panels[0]) === start[0], picture(panels[3]) === start[1],
                document.querySelector('#fig8 .reset').hidden, values(panels[3])].join();
  var map = document.querySelector('#map .chart');
  var box = map.getBoundingClientRect();
  map.querySelector('canvas:last-of-type').dispatchEvent(new MouseEvent('mousemove', {
    bubbles: true, clientX: box.left + 0.4 * box.width, clientY: box.top + 0.6 * box.height}));
  seen.cell = map.parentNode.querySelector('.values').lastChild.textContent;
  fold.open = false;
  window.dispatchEvent(new Event('beforeprint'));
  seen.openOnPaper = fold.open;
  seen.fits = Array.prototype.filter.call(document.querySelectorAll('.chart'), function (chart) {
    var columns = Number(getComputedStyle(chart.closest('figure')).getPropertyValue('--columns'));
    var paper = chart.querySelector('svg.paper');
    return paper && Number(paper.getAttribute('width')) === (columns > 1 ? 342 : 700) &&
        chart.clientWidth === Number(paper.getAttribute('width')) &&
        paper.querySelectorAll('path[stroke], path[fill]').length > 3;
  }).length;
  window.dispatchEvent(new Event('afterprint'));
  seen.printed = [picture(panels[0]) === start[0], fold.open].join();
})();
</script>
JS

browse "$probe" 10000
expect_charts "$page" 26
expect "charts with a curve" "$(seen painted)" "$charts"
expect "cursor" "$(seen cursor | cut -c1-12)" "t 0.780039 s"
expect "linked cursor" "$(seen linked-cursor | cut -c1-12)" "t 0.780039 s"
expect "cursor in another figure" "$(seen other-cursor)" ""
expect "zoom (own, linked, other figure, reset button hidden)" "$(seen zoomed)" "true,true,false,false"
expect "reset (own, linked, button hidden, values)" "$(seen reset)" "true,true,true,"
expect "cell of the map" "$(seen cell)" "■ one slip"
expect "charts drawn before the fold is opened, and of the fold" "$(seen folded-charts)" "$((charts - 1)),0"
expect "fold opened for paper" "$(seen open-on-paper)" true
expect "printing restores the picture and the fold" "$(seen printed)" true,false
expect "charts drawn as vectors that fit their column of the paper" "$(seen fits)" "$charts"
give_verdict
echo "$charts charts drawn, linked and reset without an error"
