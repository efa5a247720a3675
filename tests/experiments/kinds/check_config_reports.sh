#!/usr/bin/env bash
# check_config_reports.sh REPORTS: opens the reports that configs_test has written into the
# folder, in headless Chromium and fails on errors, on charts without a curve, on texts
# of a figure that overlap or are cut, and on a page that is wider than its window. Exit code 77:
# there is no browser.
set -euo pipefail
. "$(dirname "$0")/../report/browser.sh"
find_browser
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# Before the page's own scripts: what is written into canvases, with its box in the chart.
cat >"$folder/head" <<'JS'
<script>
var fill_text = CanvasRenderingContext2D.prototype.fillText;
CanvasRenderingContext2D.prototype.fillText = function (text, x, y) {
  var width = this.measureText(text).width;
  var left = this.textAlign === 'right' ? x - width : x;
  var texts = this.canvas.texts = this.canvas.texts || [];
  texts.push({text: text, left: left, right: left + width, top: y - 9, bottom: y + 2});
  return fill_text.apply(this, arguments);
};
</script>
JS
cat >"$folder/tail" <<'JS'
<script>
(function probe() {
  // What is folded is drawn when it is opened.
  document.querySelectorAll('details').forEach(function (fold) { fold.open = true; });
  if (window.__modcal_ready !== document.querySelectorAll('.chart').length) {
    setTimeout(probe, 20);
    return;
  }
  var findings = [];
  var all = function (selector, within) {
    return Array.prototype.slice.call((within || document).querySelectorAll(selector));
  };
  // Boxes of all texts below an element, each as large as its letters: a line is taller.
  function texts_of(element) {
    var list = [];
    var walker = document.createTreeWalker(element, NodeFilter.SHOW_TEXT);
    for (var node = walker.nextNode(); node; node = walker.nextNode()) {
      if (!node.textContent.trim() || node.parentElement.closest('[hidden], .values')) continue;
      var range = document.createRange();
      range.selectNodeContents(node);
      Array.prototype.forEach.call(range.getClientRects(), function (box) {
        var x = box.height > box.width ? 0.18 * box.width : 0;
        var y = box.height > box.width ? 0 : 0.18 * box.height;
        list.push({text: node.textContent.trim(), left: box.left + x, right: box.right - x,
                   top: box.top + y, bottom: box.bottom - y});
      });
    }
    all('canvas', element).forEach(function (canvas) {
      var origin = canvas.getBoundingClientRect();
      (canvas.texts || []).forEach(function (t) {
        list.push({text: t.text, left: origin.left + t.left, right: origin.left + t.right,
                   top: origin.top + t.top, bottom: origin.top + t.bottom});
      });
    });
    return list;
  }
  function overlap(a, b) {
    return Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 &&
        Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1;
  }
  // Pixels of the curves' canvas that are not of the grid's gray.
  function is_painted(chart) {
    var canvas = chart.querySelector('canvas');
    var pixels = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
    for (var i = 0, painted = 0; i < pixels.length; i += 4) {
      var high = Math.max(pixels[i], pixels[i + 1], pixels[i + 2]);
      var low = Math.min(pixels[i], pixels[i + 1], pixels[i + 2]);
      if (pixels[i + 3] > 120 && (high - low > 40 || high < 80)) painted++;
    }
    return painted > 20;
  }
  all('figure').forEach(function (figure) {
    var frame = figure.getBoundingClientRect();
    all('.panel', figure).forEach(function (panel, place) {
      var name = figure.id + ' panel ' + (place + 1) + ': ';
      var chart = panel.querySelector('.chart');
      if (!chart || !is_painted(chart)) findings.push(name + 'empty');
      var box = panel.getBoundingClientRect();
      var texts = texts_of(panel);
      texts.forEach(function (t, i) {
        if (t.left < box.left - 1 || t.right > box.right + 1 || t.bottom > box.bottom + 1) {
          findings.push(name + '"' + t.text + '" is cut');
        }
        texts.slice(i + 1).forEach(function (other) {
          if (overlap(t, other)) findings.push(name + '"' + t.text + '" over "' + other.text + '"');
        });
      });
    });
    texts_of(figure.querySelector('.caption-head')).forEach(function (t) {
      if (t.right > frame.right + 1) findings.push(figure.id + ': "' + t.text + '" is cut');
    });
  });
  var root = document.documentElement;
  if (root.scrollWidth > root.clientWidth) findings.push('page of ' + root.scrollWidth + ' pixels');
  all('table').forEach(function (table) {
    var frame = table.parentNode;
    if (table.scrollWidth > frame.clientWidth && getComputedStyle(frame).overflowX !== 'auto') {
      findings.push('table ' + frame.parentNode.id + ' is cut');
    }
  });
  if (Number(root.dataset.errors)) findings.push(root.dataset.errors + ' errors');
  window.parent.postMessage(findings, '*');
})();
</script>
JS

# One browser looks at them one after the other, at the width of a desk and of a tablet.
pages=0
list=
while read -r page; do
  pages=$((pages + 1))
  { sed "/<head>/r $folder/head" "$page"; cat "$folder/tail"; } >"${page%.html}_probe.html"
  list+="'${page%.html}_probe.html',"
done <"$1/pages"
cat >"$folder/index.html" <<HTML
<html><body><script>
var pages = [$list], widths = [1400, 800], looked = 0, found = [], frame = null;
function next() {
  if (frame) frame.remove();
  document.documentElement.dataset.looked = looked;
  document.documentElement.dataset.findings = found.join(' | ');
  if (looked === pages.length * widths.length) return;
  frame = document.createElement('iframe');
  frame.width = widths[looked % widths.length];
  frame.height = 1000;
  frame.src = 'file://' + pages[Math.floor(looked / widths.length)];
  document.body.appendChild(frame);
}
window.addEventListener('message', function (event) {
  var page = frame.src.replace('file://$1/', '').replace('/report_probe.html', '');
  event.data.forEach(function (text) {
    found.push(page + ' at ' + frame.width + ': ' + text.replace(/["|]/g, "'"));
  });
  looked++;
  next();
});
next();
</script></body></html>
HTML
browse "$folder/index.html" 1000000
expect "looks at pages" "$(seen looked)" "$((2 * pages))"
expect "findings" "$(seen findings | sed 's/ | /\n/g')" ""
expect_silent_console
[ "$pages" -gt 10 ] || { echo "only $pages reports"; failures=1; }
give_verdict
echo "$pages reports without an error"
