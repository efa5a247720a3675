# To be sourced: looks at a page in headless Chromium and compares what it says of itself with what is expected.

# Ends the test with code 77 where there is no browser.
find_browser() {
  browser=$(command -v chromium || command -v chromium-browser || true)
  [ -n "$browser" ] && return
  echo "no chromium: the page is not looked at (install the packages marked test in packages.txt)"
  exit 77
}

# browse PAGE MILLISECONDS: leaves the document in $dom and the browser's log in $folder/log.
browse() {
  dom=$("$browser" --headless --no-sandbox --disable-gpu --disable-quic --no-first-run \
    --disable-background-networking --disable-component-update --disable-sync \
    --user-data-dir="$folder/profile$RANDOM" --enable-logging=stderr --virtual-time-budget="$2" \
    --window-size=1400,1000 --dump-dom "file://$1" 2>"$folder/log")
}

# seen NAME: attribute data-NAME of the root element of $dom.
seen() { grep -o "<html [^>]*>" <<<"$dom" | grep -o " data-$1=\"[^\"]*\"" | cut -d'"' -f2; }

failures=0
# expect WHAT ACTUAL EXPECTED
expect() {
  [ "$2" = "$3" ] && return
  echo "$1: \"$2\" instead of \"$3\""
  failures=$((failures + 1))
}
# Charts in the page: all drawn, without an error.
expect_charts() {
  charts=$(grep -o '<div class="chart[" ]' "$1" | wc -l)
  expect "charts in the page" "$charts" "$2"
  expect "charts drawn" "$(seen charts)" "$charts"
  expect "errors" "$(seen errors)" 0
  expect_silent_console
}
# A log that is not there is no silence.
expect_silent_console() { expect "console" "$(sed -n '/CONSOLE/p' "$folder/log" 2>&1)" ""; }
give_verdict() {
  [ "$failures" -eq 0 ] && return
  sed -n 1,20p "$folder/log"
  exit 1
}
