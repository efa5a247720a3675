// Charts on paper: drawn anew at the paper's size, as vectors. A canvas that is drawn while the
// browser prints stays blank, and one that is zoomed has blurred curves and labels of another size.
var svg_space = 'http://www.w3.org/2000/svg';
var clips = 0;

function svg_element(name, attributes) {
  var element = document.createElementNS(svg_space, name);
  Object.keys(attributes).forEach(function (key) { element.setAttribute(key, attributes[key]); });
  return element;
}

// Takes what a canvas is told to paint, of which dygraphs and marks.js use this much.
function SvgContext(width, height) {
  this.svg = svg_element('svg', {width: width, height: height, 'class': 'paper'});
  this.canvas = {width: width, height: height};
  this.path = '';
  this.saved = [];
  Object.assign(this, {strokeStyle: '#000', fillStyle: '#000', lineWidth: 1, globalAlpha: 1,
                       lineJoin: 'miter', dash: [], clipped: null});
}

SvgContext.prototype = {
  save: function () {
    var state = {};
    ['strokeStyle', 'fillStyle', 'lineWidth', 'globalAlpha', 'lineJoin', 'dash', 'clipped'].forEach(
        function (key) { state[key] = this[key]; }, this);
    this.saved.push(state);
  },
  restore: function () { Object.assign(this, this.saved.pop()); },
  scale: function () {},  // of the screen's pixels
  clearRect: function () { this.svg.textContent = ''; },
  setLineDash: function (dash) { this.dash = dash || []; },
  beginPath: function () { this.path = ''; },
  closePath: function () { this.path += 'Z'; },
  moveTo: function (x, y) { this.path += 'M' + x.toFixed(2) + ' ' + y.toFixed(2); },
  lineTo: function (x, y) { this.path += (this.path ? 'L' : 'M') + x.toFixed(2) + ' ' + y.toFixed(2); },
  rect: function (x, y, w, h) { this.path += 'M' + [x, y] + 'h' + w + 'v' + h + 'h' + -w + 'Z'; },
  arc: function (x, y, r) {  // whole circles
    var turn = 'a' + [r, r, 0, 1, 0];
    this.path += 'M' + [x - r, y] + turn + ',' + [2 * r, 0] + turn + ',' + [-2 * r, 0];
  },
  clip: function () {
    var clip = svg_element('clipPath', {id: 'clip' + ++clips});
    clip.appendChild(svg_element('path', {d: this.path}));
    this.svg.appendChild(clip);
    this.clipped = clip;
  },
  add: function (attributes) {
    if (!attributes.d || !isFinite(this.globalAlpha)) return;
    if (this.globalAlpha < 1) attributes.opacity = this.globalAlpha;
    if (this.clipped) {
      if (!this.clipped.parentNode) this.svg.appendChild(this.clipped);
      attributes['clip-path'] = 'url(#' + this.clipped.id + ')';
    }
    this.svg.appendChild(svg_element('path', attributes));
  },
  stroke: function () {
    this.add({d: this.path, fill: 'none', stroke: this.strokeStyle, 'stroke-width': this.lineWidth,
              'stroke-linejoin': this.lineJoin, 'stroke-dasharray': this.dash.join(' ')});
  },
  fill: function () { this.add({d: this.path, fill: this.fillStyle}); },
  fillRect: function (x, y, w, h) {
    this.beginPath();
    this.rect(x, y, w, h);
    this.add({d: this.path, fill: this.fillStyle, 'shape-rendering': 'crispEdges'});
  }
};

// Labels and room of a chart on the screen and on paper, where 1 px is 0.75 points.
function sizes(on_paper) {
  return {
    axisLabelFontSize: on_paper ? 9.5 : 12, xLabelHeight: on_paper ? 15 : 18, yLabelWidth: on_paper ? 15 : 18,
    axes: {x: {pixelsPerLabel: on_paper ? 42 : 52}, y: {pixelsPerLabel: on_paper ? 24 : 28,
                                                        axisLabelWidth: on_paper ? 50 : 76}}
  };
}

// The paper is 700 pixels wide.
function put_on_paper(item) {
  if (!item.element.clientWidth) return;  // filtered away
  var columns = Number(getComputedStyle(item.figure).getPropertyValue('--columns'));
  var narrow = columns > 1 || item.figure.matches('.row > :not(:last-child:nth-child(odd))');
  var width = narrow ? 342 : 700;
  var height = item.panel.map ? Math.round(0.67 * width) : narrow ? 205 : 270;
  var paper = new SvgContext(width, height);
  item.screen = item.chart.hidden_ctx_;
  item.chart.hidden_ctx_ = paper;
  item.chart.updateOptions(Object.assign(sizes(true), looks(item.series)), true);
  item.chart.resize(width, height);
  var sheet = item.chart.graphDiv;
  item.paper = sheet.insertBefore(paper.svg, sheet.firstChild);
}

function take_from_paper(item) {
  if (!item.paper) return;
  item.paper.remove();
  item.paper = null;
  item.chart.hidden_ctx_ = item.screen;
  item.element.style.width = item.element.style.height = '';
  item.chart.updateOptions(Object.assign(sizes(false), looks(item.series)), true);
  item.chart.resize();
}

// A table wider than the paper would make the browser shrink all that is on the page.
function fit_table_to_paper(table) {
  if (table.offsetWidth > 700) table.style.zoom = (700 / table.offsetWidth).toFixed(4);
}
