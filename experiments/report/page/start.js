// When charts are drawn: what is in sight at once, what is folded when it is opened or printed.
// window.__modcal_ready is the number of charts that have been drawn, or have said why not, once
// all that are in sight have. Last part of the page's script.
read_facets();
var waiting = Array.prototype.slice.call(document.querySelectorAll('.chart'));
var all_charts = waiting.length;
var linked_figures = [];

function folds_of(element) {
  var folds = [];
  for (var fold = element.closest('details'); fold; fold = fold.parentElement.closest('details')) folds.push(fold);
  return folds;
}

function is_in_sight(element) {
  return folds_of(element).every(function (fold) { return fold.open; });
}

function finish() {
  document.querySelectorAll('figure').forEach(function (figure) {
    var is_waiting = waiting.some(function (element) { return figure.contains(element); });
    if (is_waiting || linked_figures.indexOf(figure) >= 0) return;
    linked_figures.push(figure);
    link_zoom(figure);
  });
  apply_filters();
  window.__modcal_ready = all_charts - waiting.length;
  root.dataset.charts = String(charts.length);
}

// A chart that cannot be drawn says so, is reported on the console and leaves the others alone.
function draw_safely(element) {
  try {
    draw(element);
  } catch (error) {
    element.textContent = 'This chart could not be drawn: ' + error.message;
    setTimeout(function () { throw error; }, 0);
  }
}

// In slices, from the top of the page: it can be read and scrolled while the rest is drawn.
function draw_waiting(until) {
  var next = waiting.findIndex(is_in_sight);
  for (; next >= 0 && performance.now() < until; next = waiting.findIndex(is_in_sight)) {
    draw_safely(waiting.splice(next, 1)[0]);
  }
  if (next < 0) return finish();
  setTimeout(function () { draw_waiting(performance.now() + 30); }, 0);
}

window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', repaint);
// What was drawn before it was folded may have another width now. The event does not bubble.
document.addEventListener('toggle', function (event) {
  if (!event.target.open) return;
  charts.forEach(function (item) {
    if (event.target.contains(item.element) && !item.paper) item.chart.resize();
  });
  draw_waiting(performance.now() + 500);
}, true);

// What is folded is found by a link to it.
function go_to_hash() {
  var target = document.getElementById(location.hash.slice(1));
  if (!target) return;
  folds_of(target).concat(Array.prototype.slice.call(target.querySelectorAll('details.fold')))
      .forEach(function (fold) { fold.open = true; });
  target.scrollIntoView();
}
window.addEventListener('hashchange', go_to_hash);

// Paper shows all; what was folded before is folded again.
var opened_for_paper = [];
window.addEventListener('beforeprint', function () {
  opened_for_paper = Array.prototype.slice.call(document.querySelectorAll('details:not([open])'));
  opened_for_paper.forEach(function (fold) { fold.open = true; });
  draw_waiting(Infinity);
  root.classList.add('printing');
  charts.forEach(put_on_paper);
  document.querySelectorAll('table').forEach(fit_table_to_paper);
});
window.addEventListener('afterprint', function () {
  root.classList.remove('printing');
  document.querySelectorAll('table').forEach(function (table) { table.style.zoom = ''; });
  charts.forEach(take_from_paper);
  opened_for_paper.forEach(function (fold) { fold.open = false; });
});
make_filters(apply_filters);
offer_cell_replays();
go_to_hash();
// What is not drawn before the page has loaded is not in a PDF that is made at once.
draw_waiting(performance.now() + 500);
