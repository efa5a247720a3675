// The numbers of the page: arrays from #modcal-data, rows for dygraphs, texts and ticks of axes.
// First part of the page's script; its parts stand in one function: values, marks, filters, report.
var root = document.documentElement;
window.__modcal_ready = null;
root.dataset.errors = '0';
window.addEventListener('error', function () {
  root.dataset.errors = String(Number(root.dataset.errors) + 1);
});

var data = JSON.parse(document.getElementById('modcal-data').textContent);
var decoded = [];

function numbers(index) {
  if (index === undefined) return null;
  if (!decoded[index]) {
    var source = data.arrays[index];
    var text = atob(source.d);
    var bytes = new Uint8Array(text.length);
    for (var i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
    var values = source.t === 'f8' ? new Float64Array(bytes.buffer) : new Float32Array(bytes.buffer);
    decoded[index] = Float64Array.from(values, function (v) { return v + (source.o || 0); });
  }
  return decoded[index];
}

// Index of the sample nearest to x.
function nearest(xs, x) {
  var low = 0;
  var high = xs.length - 1;
  while (high - low > 1) {
    var middle = (low + high) >> 1;
    if (xs[middle] < x) low = middle; else high = middle;
  }
  return Math.abs(xs[low] - x) <= Math.abs(xs[high] - x) ? low : high;
}

function power(exponent) {
  return '10' + String(exponent).replace(/./g, function (c) {
    return c === '-' ? '\u207b' : '\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079'[c];
  });
}

// f_c and f0 as symbols with subscripts; for HTML. As typeset.cpp does in texts.
function symbols(html) {
  html = html.replace(/(^|[^A-Za-z0-9/._])(f0|[RH][12])(?![A-Za-z0-9_])/g, function (all, before, name) {
    return before + name[0] + '<sub>' + name[1] + '</sub>';
  });
  return html.replace(/(^|[^A-Za-z0-9])([A-Za-z\u03b1-\u03c9])_([A-Za-z0-9]{1,2})(?![A-Za-z0-9_])/g, '$1$2<sub>$3</sub>');
}

// Shortest text of a number with so many significant digits.
function shown(value, digits) {
  if (!isFinite(value)) return 'NaN';
  var size = Math.abs(value);
  var text;
  if (size === 0 || (size >= 1e-3 && size < 1e5)) {
    text = String(Number(value.toPrecision(digits)));
  } else {
    var parts = value.toExponential(digits - 1).split('e');
    var mantissa = String(Number(parts[0]));
    var tail = power(Number(parts[1]));
    text = mantissa === '1' ? tail : mantissa === '-1' ? '-' + tail : mantissa + '\u00d7' + tail;
  }
  return text.replace('-', '\u2212');
}

// dygraphs' ticks; on a logarithmic axis only the decades are labelled where there are enough.
function ticks(low, high, pixels, options, chart, values) {
  var list = Dygraph.numericTicks(low, high, pixels, options, chart, values);
  if (!options('logscale')) {
    // Rounding leaves 1e-17 where 0 is meant.
    list.forEach(function (tick) {
      if (Math.abs(tick.v) < 1e-9 * (high - low)) tick.label = '0';
    });
    return list;
  }
  var decades = list.filter(function (tick) {
    var exponent = Math.log10(tick.v);
    return Math.abs(exponent - Math.round(exponent)) < 1e-9;
  });
  if (decades.length < 2) return list;
  var room = Math.max(2, Math.floor(pixels / options('pixelsPerLabel')));
  var stride = Math.ceil(decades.length / room);
  list.forEach(function (tick) {
    var place = decades.indexOf(tick);
    tick.label = place >= 0 && place % stride === 0 ? power(Math.round(Math.log10(tick.v))) : '';
  });
  return list;
}

// Rows of dygraphs: the samples of all series merged by x; null where a series has no sample (the
// line goes on), NaN where it has a gap. series.rows: the row of each of its samples.
function rows(series, bars) {
  var at = series.map(function () { return 0; });
  series.forEach(function (s) { s.rows = []; });
  var result = [];
  for (;;) {
    var x = Infinity;
    series.forEach(function (s, k) { if (at[k] < s.x.length) x = Math.min(x, s.x[at[k]]); });
    if (x === Infinity) return result;
    var row = [x];
    series.forEach(function (s, k) {
      var i = at[k];
      if (i >= s.x.length || s.x[i] !== x) { row.push(null); return; }
      row.push(!bars ? s.y[i] : s.low ? [s.low[i], s.y[i], s.high[i]] : [s.y[i], s.y[i], s.y[i]]);
      s.rows.push(result.length);
      at[k]++;
    });
    result.push(row);
  }
}
