// Draws the charts of a report with dygraphs: one chart per .chart element, the charts of a figure
// linked.
var charts = [];

function escaped(text) {
  var span = document.createElement('span');
  span.textContent = text;
  return span.innerHTML;
}

function span_of(text, ink) {
  var span = document.createElement('span');
  span.innerHTML = symbols(escaped(text));
  if (ink) span.className = 'ink-' + ink;
  return span;
}

// Writes the values at x into the panel's head; of a map the one at y, where it is known.
function show_values(item, x, y) {
  var panel = item.panel;
  item.values.textContent = '';
  if (x === null) return;
  item.values.appendChild(span_of(panel.x.label + ' ' + shown(x, 6) + ' ' + panel.x.unit));
  item.series.forEach(function (s) {
    var i = nearest(s.x, x);
    var text = shown(s.y[i], 5);
    if (s.low) text += ' (' + shown(s.low[i], 4) + ' \u2026 ' + shown(s.high[i], 4) + ')';
    var named = s.label ? s.label + ' ' : '';
    item.values.appendChild(span_of(named + text + ' ' + panel.y.unit, s.ink));
  });
  if (!panel.map || y === undefined) return;
  var found = category_at(panel.map, x, y);
  item.values.appendChild(span_of(panel.y.label + ' ' + shown(y, 4) + ' ' + panel.y.unit));
  if (found) item.values.appendChild(span_of('\u25a0 ' + found.label, found.ink));
}

// Puts the cursor of one chart at x, for the keyboard and for linked charts.
function select(item, x) {
  item.row = nearest(item.xs, x);
  item.chart.setSelection(item.row);
  show_values(item, item.xs[item.row]);
}

function deselect(item) {
  item.chart.clearSelection();
  show_values(item, null);
}

function linked(item) {
  return charts.filter(function (other) {
    return other !== item && other.figure === item.figure && other.link === item.link;
  });
}

function reset(item) {
  [item].concat(linked(item)).forEach(function (each) {
    each.chart.updateOptions({dateWindow: each.panel.x.window, valueRange: each.panel.y.window});
  });
}

function differ(range, start) {
  var span = Math.abs(start[1] - start[0]);
  return Math.abs(range[0] - start[0]) > 1e-9 * span || Math.abs(range[1] - start[1]) > 1e-9 * span;
}

function zoomed(item) {
  var start = item.panel.y.window;
  return differ(item.chart.xAxisRange(), item.panel.x.window) ||
      (start ? differ(item.chart.yAxisRange(), start) : item.chart.isZoomed('y'));
}

function update_reset_button(figure) {
  figure.querySelector('.reset').hidden = !charts.some(function (item) {
    return item.figure === figure && zoomed(item);
  });
}

function zoom(item, factor) {
  var range = item.chart.xAxisRange();
  var log = item.panel.x.log;
  var ends = log ? range.map(Math.log) : range;
  var center = item.row === undefined ? (ends[0] + ends[1]) / 2
      : (log ? Math.log(item.xs[item.row]) : item.xs[item.row]);
  var window_ = ends.map(function (v) { return center + factor * (v - center); });
  item.chart.updateOptions({dateWindow: log ? window_.map(Math.exp) : window_});
}

function on_key(item, event) {
  var row = item.row === undefined ? nearest(item.xs, item.chart.xAxisRange()[0]) : item.row;
  var step = event.shiftKey ? 10 : 1;
  var go = function (to) {
    select(item, item.xs[Math.min(Math.max(to, 0), item.xs.length - 1)]);
    linked(item).forEach(function (other) { select(other, item.xs[item.row]); });
  };
  var actions = {
    ArrowLeft: function () { go(row - step); },
    ArrowRight: function () { go(row + step); },
    '+': function () { zoom(item, 0.5); },
    '-': function () { zoom(item, 2); },
    '0': function () { reset(item); },
    Enter: function () {
      var x = item.xs[row];
      var found = item.series.filter(function (s) { return s.task; })[0];
      var i = found && nearest(found.x, x);
      if (found) offer_task(item, {label: found.label, task: found.task[i], x: found.x[i], y: found.y[i]});
    },
    Escape: function () { deselect(item); linked(item).forEach(deselect); }
  };
  var action = actions[event.key];
  if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
  event.preventDefault();
  action();
}

function looks(series) {
  return {
    colors: series.map(function (s) { return color(s.ink); }),
    axisLineColor: color('line'),
    gridLineColor: color('grid')
  };
}

function read_series(panel) {
  // A dashed reference lies behind a band about what is compared with it.
  var banded = panel.series.some(function (s) { return s.low !== undefined && s.style !== 'points'; });
  var behind = function (s) { return banded && s.style === 'dashed' && s.ink === 'reference' ? 0 : 1; };
  return panel.series.slice().sort(function (a, b) { return behind(a) - behind(b); }).map(function (s) {
    return {label: s.label, style: s.style, ink: s.ink, shape: s.shape, x: numbers(s.x), y: numbers(s.y),
            low: numbers(s.low), high: numbers(s.high), path: numbers(s.path), task: numbers(s.task),
            tags: s.tags, rows: []};
  });
}

function read_map(panel) {
  if (!panel.map) return;
  ['x', 'y', 'cells'].forEach(function (key) { panel.map[key] = numbers(panel.map[key]); });
}

function axis_options(axis, pixels, width) {
  return {
    logscale: axis.log, ticker: ticks, pixelsPerLabel: pixels, axisLabelWidth: width,
    axisLabelFormatter: function (v) { return shown(v, 6); }
  };
}

// The series that the filters let through, as dygraphs takes them.
function shown_options(item) {
  item.series = item.all.filter(function (s) { return is_shown(s.tags); });
  var drawn = item.series.length ? item.series : item.all;  // a chart needs a series, even out of sight
  var table = rows(drawn, item.bars);
  item.xs = table.map(function (row) { return row[0]; });
  item.row = undefined;
  return Object.assign(looks(drawn), {
    file: table,
    labels: ['x'].concat(drawn.map(function (s) { return 's' + item.all.indexOf(s); }))
  });
}

function chart_options(item) {
  var panel = item.panel;
  var bars = item.bars;
  var per_series = {};
  item.all.forEach(function (s, k) {
    per_series['s' + k] = series_options(s, bars, s.x.length > 200);
  });
  return {
    series: per_series,
    customBars: bars,
    connectSeparatedPoints: true,
    legend: 'never',
    xlabel: symbols(escaped(panel.x.text)),
    ylabel: symbols(escaped(panel.y.text)),
    axes: {x: axis_options(panel.x, 52, 48), y: axis_options(panel.y, 28, 76)},
    title: marker_lines(panel) ? '\u00a0' : null,  // room for the labels of vertical markers
    titleHeight: 14 * marker_lines(panel),
    dateWindow: panel.x.window,
    valueRange: panel.y.window,
    yRangePad: panel.y.window ? 0 : 8,
    fillAlpha: 0.2,
    axisLabelFontSize: 12,
    xLabelHeight: 18,
    yLabelWidth: 18,
    rightGap: Math.max(24, marker_margin(panel)),
    highlightCircleSize: 3.5,
    drawGrid: !panel.map,
    underlayCallback: draw_markers(panel),
    interactionModel: Object.assign({}, Dygraph.defaultInteractionModel,
                                    {dblclick: function () { reset(item); }}),
    drawCallback: function (chart, initial) {
      label_markers(chart, panel);
      if (!initial) update_reset_button(item.figure);
    },
    highlightCallback: function (event, x, points, row) {
      item.row = row;
      var y = panel.map && item.chart.toDataYCoord(item.chart.eventToDomCoords(event)[1]);
      show_values(item, x, y || undefined);
      linked(item).forEach(function (other) { select(other, x); });
    },
    unhighlightCallback: function () {
      show_values(item, null);
      linked(item).forEach(deselect);
    }
  };
}

function draw(element) {
  var figure = element.closest('figure');
  var source = data.figures.find(function (f) { return f.id === figure.id; });
  var panel = source.panels[Number(element.dataset.panel)];
  var series = read_series(panel);
  read_map(panel);
  var item = {
    figure: figure, panel: panel, all: series, element: element,
    bars: series.some(function (s) { return s.low !== null; }),
    values: element.parentNode.querySelector('.values'),
    link: JSON.stringify([panel.x.text, panel.x.log, panel.x.window])
  };
  var shown_now = shown_options(item);
  var table = shown_now.file;
  delete shown_now.file;
  item.chart = new Dygraph(element, table, Object.assign(shown_now, chart_options(item)));
  element.addEventListener('keydown', function (event) { on_key(item, event); });
  offer_replays(item, element);
  charts.push(item);
}

// Shows what the filters let through, in charts, legends and tables.
function apply_filters() {
  charts.forEach(function (item) {
    deselect(item);
    var before = item.series;
    var options = shown_options(item);
    var empty = item.all.length > 0 && item.series.length === 0;
    var was_empty = item.element.parentNode.hidden;
    item.element.parentNode.hidden = empty;
    var same = before.length === item.series.length &&
        before.every(function (s, k) { return s === item.series[k]; });
    if (empty || (same && !was_empty)) return;
    item.chart.updateOptions(options);
    if (was_empty) item.chart.resize();
  });
  document.querySelectorAll('figure').forEach(function (figure) {
    var labels = {};
    charts.forEach(function (item) {
      if (item.figure === figure) item.series.forEach(function (s) { labels[s.label] = true; });
    });
    filter_legend(figure, labels);
  });
  filter_rows();
}

// One zoom for all charts of a figure over the same x.
function link_zoom(figure) {
  var groups = {};
  charts.forEach(function (item) {
    if (item.figure !== figure) return;
    (groups[item.link] = groups[item.link] || []).push(item.chart);
  });
  Object.keys(groups).forEach(function (key) {
    if (groups[key].length > 1) {
      Dygraph.synchronize(groups[key], {selection: false, zoom: true, range: false});
    }
  });
  figure.querySelector('.reset').addEventListener('click', function () {
    charts.forEach(function (item) {
      if (item.figure === figure) reset(item);
    });
  });
}

function repaint() {
  charts.forEach(function (item) { item.chart.updateOptions(looks(item.series)); });
}
