// What dygraphs is told to paint: colours, points, bars, curves that turn back, marker lines.
function color(name) {
  return getComputedStyle(root).getPropertyValue('--' + name).trim();
}

function polygon(c, x, y, radius, turn, corners) {
  for (var i = 0; i < corners; i++) {
    var angle = turn + 2 * Math.PI * i / corners;
    c.lineTo(x + radius * Math.cos(angle), y + radius * Math.sin(angle));
  }
  c.closePath();
}

function outline(c, shape, x, y, r) {
  shape = shape.replace('open_', '');
  if (shape === 'square') c.rect(x - r, y - r, 2 * r, 2 * r);
  else if (shape === 'triangle') polygon(c, x, y, 1.3 * r, -Math.PI / 2, 3);
  else if (shape === 'inverted_triangle') polygon(c, x, y, 1.3 * r, Math.PI / 2, 3);
  else if (shape === 'diamond') polygon(c, x, y, 1.3 * r, 0, 4);
  else c.arc(x, y, r, 0, 2 * Math.PI);
}

function point_of(shape) {
  return function (chart, name, c, x, y, paint, r) {
    c.beginPath();
    c.fillStyle = c.strokeStyle = paint;
    c.lineWidth = 1.3;
    outline(c, shape, x, y, r);
    if (shape.indexOf('open') === 0) c.stroke(); else c.fill();
  };
}

function draw_bars(e) {
  var c = e.drawingContext;
  c.save();
  c.strokeStyle = e.color;
  c.lineWidth = 1.2;
  c.beginPath();
  e.points.forEach(function (p) {
    if (!isFinite(p.canvasy)) return;
    var ends = [p.y_top, p.y_bottom].map(function (v) { return e.plotArea.y + v * e.plotArea.h; });
    c.moveTo(p.canvasx, ends[0]);
    c.lineTo(p.canvasx, ends[1]);
    ends.forEach(function (y) { c.moveTo(p.canvasx - 3, y); c.lineTo(p.canvasx + 3, y); });
  });
  c.stroke();
  c.restore();
}

// Line through the samples in their own order, for curves whose x turns back.
function path_plotter(s) {
  return function (e) {
    if (!e.points.length) return;
    var c = e.drawingContext;
    var first = e.points[0].idx;
    var down = false;
    c.beginPath();
    s.path.forEach(function (place) {
      var p = e.points[s.rows[place] - first];
      if (!p || !isFinite(p.canvasy)) { down = false; return; }
      if (down) c.lineTo(p.canvasx, p.canvasy); else c.moveTo(p.canvasx, p.canvasy);
      down = true;
    });
    c.stroke();
  };
}

function plotter_of(s, bars) {
  var list = [Dygraph.Plotters.linePlotter];
  if (s.path) {
    list = s.style === 'line_with_points' ? [path_plotter(s), points_only] : [path_plotter(s)];
  }
  if (bars && s.low) list.unshift(s.style === 'points' ? draw_bars : Dygraph.Plotters.errorPlotter);
  return function (e) {
    e.drawingContext.lineJoin = 'round';  // mitred peaks overshoot
    list.forEach(function (plotter) { plotter(e); });
  };
}

function points_only(e) {
  var draw = e.dygraph.getOption('drawPointCallback', e.setName);
  var size = e.dygraph.getOption('pointSize', e.setName);
  e.points.forEach(function (p) {
    if (isFinite(p.canvasy)) {
      draw(e.dygraph, e.setName, e.drawingContext, p.canvasx, p.canvasy, e.color, size);
    }
  });
}

function series_options(s, bars, dense) {
  var points = s.style === 'points' || s.style === 'line_with_points';
  return {
    strokeWidth: s.style === 'points' ? 0 : s.style === 'dashed' ? 1.2 : 1.4,
    strokePattern: s.style === 'dashed' ? [4, 2] : null,
    drawPoints: points,
    pointSize: dense ? 1.6 : 3.2,
    drawPointCallback: point_of(s.shape),
    drawHighlightPointCallback: point_of(s.shape),
    plotter: plotter_of(s, bars)
  };
}

// Pixels of a cell's borders: whole ones, so that neighbours meet without a seam.
function pixels_of(edges, to_pixel) {
  return Array.from(edges, function (edge) { return Math.round(to_pixel(edge)); });
}

function draw_map(c, area, chart, map) {
  // Not toDomXCoord(), which is linear on a logarithmic axis, too.
  var x = pixels_of(map.x, function (v) { return area.x + area.w * chart.toPercentXCoord(v); });
  var y = pixels_of(map.y, function (v) { return area.y + area.h * chart.toPercentYCoord(v); });
  var columns = x.length - 1;
  c.save();
  c.globalAlpha = 0.82;
  map.categories.forEach(function (category, kind) {
    c.fillStyle = color(category.ink);
    for (var j = 0; j + 1 < y.length; j++) {
      for (var i = 0; i < columns; i++) {
        if (map.cells[j * columns + i] === kind) c.fillRect(x[i], y[j + 1], x[i + 1] - x[i], y[j] - y[j + 1]);
      }
    }
  });
  c.restore();
}

// Place of a value between ascending edges; -1: outside.
function cell_at(edges, value) {
  for (var i = 0; i + 1 < edges.length; i++) {
    if (value >= edges[i] && value < edges[i + 1]) return i;
  }
  return -1;
}

// Category of the map at a point; null: none.
function category_at(map, x, y) {
  var i = cell_at(map.x, x);
  var j = cell_at(map.y, y);
  return i < 0 || j < 0 ? null : map.categories[map.cells[j * (map.x.length - 1) + i]] || null;
}

// The lines of the markers; their labels stand outside the axes, where no curve runs.
function draw_markers(panel) {
  return function (c, area, chart) {
    c.save();
    c.beginPath();
    c.rect(area.x, area.y, area.w, area.h);
    c.clip();
    if (panel.map) draw_map(c, area, chart, panel.map);
    c.setLineDash([2, 3]);
    c.lineWidth = 1;
    panel.markers.forEach(function (m) {
      var share = share_of(chart, m);
      if (!(share >= 0 && share <= 1)) return;
      c.strokeStyle = color(m.ink);
      var x = area.x + share * area.w;
      var y = area.y + share * area.h;
      c.beginPath();
      c.moveTo(m.vertical ? x : area.x, m.vertical ? area.y : y);
      c.lineTo(m.vertical ? x : area.x + area.w, m.vertical ? area.y + area.h : y);
      c.stroke();
    });
    c.restore();
  };
}

function share_of(chart, marker) {
  return marker.vertical ? chart.toPercentXCoord(marker.value) : chart.toPercentYCoord(marker.value);
}

function labelled(panel, vertical) {
  return panel.markers.filter(function (m) { return m.label && m.vertical === vertical; });
}

// Lines of labels above the axes, should all vertical markers stand at one place.
function marker_lines(panel) { return Math.min(3, labelled(panel, true).length); }

// Pixels beside the axes that the labels of horizontal markers take.
function marker_margin(panel) {
  var c = document.createElement('canvas').getContext('2d');
  c.font = '12px system-ui, "DejaVu Sans", sans-serif';
  return labelled(panel, false).reduce(function (widest, m) {
    return Math.max(widest, c.measureText(m.label).width + 10);
  }, 0);
}

// Puts the labels above the axes or right of them, each where no other one stands.
function label_markers(chart, panel) {
  var area = chart.getArea();
  var root_ = chart.graphDiv;
  root_.querySelectorAll('.marker').forEach(function (old) { old.remove(); });
  var taken = [];
  panel.markers.forEach(function (m) {
    var share = share_of(chart, m);
    if (!m.label || !(share >= 0 && share <= 1)) return;
    var label = document.createElement('span');
    label.className = 'marker ink-' + m.ink;
    label.innerHTML = symbols(escaped(m.label));
    root_.appendChild(label);
    var wide = label.offsetWidth;
    var left = m.vertical
        ? Math.max(0, Math.min(area.x + share * area.w - wide / 2, root_.clientWidth - wide))
        : area.x + area.w + 5;
    var top = m.vertical ? area.y - 14 : area.y + share * area.h - 7;
    var in_the_way = function (t) {
      return t.left < left + wide + 4 && left < t.left + t.wide + 4 && Math.abs(t.top - top) < 12;
    };
    while (taken.some(in_the_way)) top += m.vertical ? -13 : 13;
    taken.push({left: left, top: top, wide: wide});
    label.style.left = left + 'px';
    label.style.top = top + 'px';
  });
}
