#!/usr/bin/env bash
# check_config_pdfs.sh REPORTS: prints the reports that configs_test has written into the
# folder to PDF by headless Chromium and fails on blank pages, on words that overlap or
# leave the page, on charts and tables that are cut, split over two pages or not beside each other, on headings
# that end a page;
# and on words of the figures that gnuplot draws that overlap or leave their sheet.
# Exit code 77: there is no browser, no chromedriver with Selenium, or no pdftotext.
set -euo pipefail
here=$(dirname "$0")
. "$here/../report/browser.sh"
find_browser
command -v pdftotext >/dev/null || { echo "no pdftotext: install poppler-utils"; exit 77; }
python="/usr/bin/python3" # the distribution's, which has its Selenium
if ! "$python" -c "import selenium" 2>/dev/null || ! command -v chromedriver >/dev/null; then
  echo "no chromedriver with Selenium: install chromium-driver and python3-selenium"
  exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# Words that nobody reads stand in the corners of every chart and at the end of every table's head:
# their places in the PDF are those of the chart and of the table.
cat >"$folder/marks" <<'JS'
<style>
.chart { position: relative; }
.probe { position: absolute; font: 3px/3px sans-serif; color: #fefefe; z-index: 99; }
th .probe, h2 .probe, h3 .probe { position: static; }
</style>
<script>
window.addEventListener('beforeprint', function () {
  function mark(parent, text, style) {
    var word = document.createElement('span');
    word.className = 'probe';
    word.textContent = text;
    word.style = style;
    parent.appendChild(word);
  }
  document.querySelectorAll('figure').forEach(function (figure, f) {
    var columns = Number(getComputedStyle(figure).getPropertyValue('--columns')) > 1 ? 2 : 1;
    var shared = figure.matches('.row > :not(:last-child:nth-child(odd))');
    figure.querySelectorAll('.chart').forEach(function (chart, c) {
      var name = [f, c, columns, columns > 1 || shared ? 2 : 1].join('x');
      mark(chart, 'qqtop' + name, 'left: 0; top: 0');
      mark(chart, 'qqend' + name, 'right: 0; bottom: 0');
    });
  });
  document.querySelectorAll('section h2, section h3').forEach(function (heading, h) {
    mark(heading, 'qqhead' + h, '');
  });
  document.querySelectorAll('table').forEach(function (table, t) {
    mark(table.querySelector('th:last-child'), 'qqtable' + t, '');
  });
});
</script>
JS
while read -r page; do
  { cat "$page"; cat "$folder/marks"; } >"${page%.html}_marked.html"
  echo "${page%.html}_marked.html ${page%.html}.pdf"
done <"$1/pages" >"$folder/pairs"
"$python" "$here/print_pages.py" "$browser" "$folder/profile" <"$folder/pairs"
pages=0
while read -r page; do
  pages=$((pages + 1))
  pdf=${page%.html}.pdf
  # Charts are drawn as vectors: a bitmap is one that the paper has blurred.
  pdfimages -list "$pdf" | sed -n "3,\$s|^|${page#"$1/"}: a picture: |p" >>"$folder/found"
  echo "$pdf $page" >>"$folder/printed"
done <"$1/pages"
find "$1" -path '*/figures/*.pdf' | sort >"$folder/drawn"
figures=$(wc -l <"$folder/drawn")
cat "$folder/printed" "$folder/drawn" | /usr/bin/python3 "$here/pdf_findings.py" "$1" >>"$folder/found"
[ "$figures" -gt 30 ] || { echo "only $figures figures"; exit 1; }
[ "$pages" -gt 10 ] || { echo "only $pages reports"; exit 1; }
[ ! -s "$folder/found" ] || { cat "$folder/found"; exit 1; }
echo "$pages reports and $figures figures printed without an error"
