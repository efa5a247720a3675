// Filters by the tags of series and rows, and the command that replays the task behind a point.
var facets = {};

// Facet by name with its values in the order in which they are met.
function note_tags(tags) {
  Object.keys(tags || {}).forEach(function (name) {
    var facet = facets[name] = facets[name] || {values: [], chosen: {}};
    tags[name].forEach(function (value) {
      if (facet.values.indexOf(value) < 0) facet.values.push(value);
    });
  });
}

// One value at a time where "all" is one of them, else any of them.
function choose_first() {
  Object.keys(facets).forEach(function (name) {
    var facet = facets[name];
    facet.single = facet.values.indexOf('all') >= 0;
    facet.values.forEach(function (value) { facet.chosen[value] = !facet.single || value === 'all'; });
  });
}

function is_shown(tags) {
  return Object.keys(tags || {}).every(function (name) {
    return tags[name].some(function (value) { return facets[name].chosen[value]; });
  });
}

function tagged_rows() {
  return Array.prototype.slice.call(document.querySelectorAll('tr[data-tags]'));
}

function element(tag, text, parent) {
  var made = document.createElement(tag);
  if (text) made.textContent = text;
  if (parent) parent.appendChild(made);
  return made;
}

function single_control(name, facet, changed) {
  var label = element('label', name + ' ');
  var select = element('select', '', label);
  select.name = name;
  ['all'].concat(facet.values.filter(function (v) { return v !== 'all'; })).forEach(function (value) {
    element('option', value, select).value = value;
  });
  select.addEventListener('change', function () {
    facet.values.forEach(function (value) { facet.chosen[value] = value === select.value; });
    changed();
  });
  return label;
}

function many_control(name, facet, changed) {
  var details = element('details');
  var summary = element('summary', '', details);
  var list = element('div', '', details);
  var boxes = facet.values.map(function (value) {
    var label = element('label', '', list);
    var box = element('input', '', label);
    box.type = 'checkbox';
    box.name = name;
    box.value = value;
    box.checked = true;
    label.appendChild(document.createTextNode(' ' + value));
    box.addEventListener('change', update);
    return box;
  });
  [['all', true], ['none', false]].forEach(function (choice) {
    var button = element('button', choice[0], list);
    button.type = 'button';
    button.addEventListener('click', function () {
      boxes.forEach(function (box) { box.checked = choice[1]; });
      update();
    });
  });
  function show_count() {
    var count = boxes.filter(function (box) { return box.checked; }).length;
    summary.textContent = name + ': ' + (count === boxes.length ? 'all' : count + ' of ' + boxes.length);
  }
  function update() {
    boxes.forEach(function (box) { facet.chosen[box.value] = box.checked; });
    show_count();
    changed();
  }
  show_count();
  return details;
}

// Collects the tags of the page; the bar stays away where there is nothing to choose.
function read_facets() {
  data.figures.forEach(function (figure) {
    figure.panels.forEach(function (panel) {
      panel.series.forEach(function (series) { note_tags(series.tags); });
    });
  });
  tagged_rows().forEach(function (row) { note_tags(JSON.parse(row.dataset.tags)); });
  choose_first();
}

function make_filters(changed) {
  var bar = document.getElementById('filters');
  var names = Object.keys(facets).filter(function (name) { return facets[name].values.length > 1; });
  if (!bar || !names.length) return;
  names.forEach(function (name) {
    var facet = facets[name];
    bar.appendChild((facet.single ? single_control : many_control)(name, facet, changed));
  });
  bar.hidden = false;
}

function filter_rows() {
  tagged_rows().forEach(function (row) { row.hidden = !is_shown(JSON.parse(row.dataset.tags)); });
}

// Hides the legend's entries whose series are all filtered away.
function filter_legend(figure, shown_labels) {
  figure.querySelectorAll('.key[data-label]').forEach(function (key) {
    key.hidden = !shown_labels[key.dataset.label];
  });
}

var replay_bar = document.getElementById('replay');

function show_replay(what, task) {
  if (!data.replay || !(task >= 0)) return;
  replay_bar.querySelector('.what').textContent = what;
  replay_bar.querySelector('code').textContent = data.replay + ' ' + task;
  replay_bar.hidden = false;
}

// Task of the point nearest to a place in the chart; null: none within reach.
function task_near(item, x, y) {
  var area = item.chart.getArea();
  var best = null;
  var least = 20 * 20;
  item.series.forEach(function (s) {
    if (!s.task) return;
    for (var i = 0; i < s.x.length; i++) {
      if (!(s.task[i] >= 0) || !isFinite(s.y[i])) continue;
      var dx = area.x + area.w * item.chart.toPercentXCoord(s.x[i]) - x;
      var dy = area.y + area.h * item.chart.toPercentYCoord(s.y[i]) - y;
      if (dx * dx + dy * dy >= least) continue;
      least = dx * dx + dy * dy;
      best = {label: s.label, task: s.task[i], x: s.x[i], y: s.y[i]};
    }
  });
  return best;
}

function offer_task(item, found) {
  if (!found) return;
  show_replay(found.label + ': ' + item.panel.x.label + ' ' + shown(found.x, 4) + ' ' + item.panel.x.unit + ', ' +
              item.panel.y.label + ' ' + shown(found.y, 4) + ' ' + item.panel.y.unit, found.task);
}

// A click, not the end of a drag.
function offer_replays(item, chart_element) {
  var down = null;
  chart_element.addEventListener('mousedown', function (event) { down = [event.clientX, event.clientY]; });
  chart_element.addEventListener('click', function (event) {
    if (down && Math.abs(down[0] - event.clientX) + Math.abs(down[1] - event.clientY) > 4) return;
    var place = item.chart.eventToDomCoords(event);
    offer_task(item, task_near(item, place[0], place[1]));
  });
}

function offer_cell_replays() {
  document.querySelectorAll('td[data-task]').forEach(function (cell) {
    cell.addEventListener('click', function () {
      var row = Array.prototype.slice.call(cell.parentNode.children);
      var heading = cell.closest('table').querySelectorAll('th')[row.indexOf(cell)];
      var name = row.filter(function (td) { return td.classList.contains('text'); }).slice(0, 2);
      show_replay(name.map(function (td) { return td.textContent.trim(); }).join(', ') + ', ' +
                  heading.textContent.trim() + ': ' + cell.textContent.trim(), Number(cell.dataset.task));
    });
  });
  if (!replay_bar) return;
  replay_bar.querySelector('.copy').addEventListener('click', function () {
    var range = document.createRange();
    range.selectNodeContents(replay_bar.querySelector('code'));
    getSelection().removeAllRanges();
    getSelection().addRange(range);
    document.execCommand('copy');
  });
  replay_bar.querySelector('.close').addEventListener('click', function () { replay_bar.hidden = true; });
}
