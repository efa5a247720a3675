#include "experiments/report/figure.hpp"

#include <algorithm>
#include <cmath>

#include "libsim/base/error.hpp"

namespace modcal::report {
namespace {

void check_axis(const Axis& axis, const std::string& figure_id) {
  if (!axis.range) return;
  const auto [low, high] = *axis.range;
  MODCAL_REQUIRE(std::isfinite(low) && std::isfinite(high) && low < high,
                 "figure \"{}\": axis \"{}\" cannot show [{}, {}]; give a lowest value below the "
                 "highest one",
                 figure_id, axis.label, low, high);
  MODCAL_REQUIRE(!axis.logarithmic || low > 0.0,
                 "figure \"{}\": logarithmic axis \"{}\" cannot start at {}; start above 0",
                 figure_id, axis.label, low);
}

void check_series(const Series& series, const std::string& figure_id) {
  const std::size_t n = series.x.size();
  MODCAL_REQUIRE(series.y.size() == n,
                 "figure \"{}\": series \"{}\" has {} values of x and {} of y; give as many",
                 figure_id, series.label, n, series.y.size());
  const bool without_spread = series.y_low.empty() && series.y_high.empty();
  MODCAL_REQUIRE(without_spread || (series.y_low.size() == n && series.y_high.size() == n),
                 "figure \"{}\": series \"{}\" has {} samples, {} lower and {} upper ends of its "
                 "spread; give both ends for every sample or none",
                 figure_id, series.label, n, series.y_low.size(), series.y_high.size());
  MODCAL_REQUIRE(series.tasks.empty() || series.tasks.size() == n,
                 "figure \"{}\": series \"{}\" has {} samples and {} task numbers; give as many or "
                 "none",
                 figure_id, series.label, n, series.tasks.size());
}

void check_marker(const Marker& marker, const Panel& panel, const std::string& figure_id) {
  const Axis& axis = marker.direction == Marker::Direction::kVertical ? panel.x : panel.y;
  MODCAL_REQUIRE(std::isfinite(marker.value) && (!axis.logarithmic || marker.value > 0.0),
                 "figure \"{}\": marker \"{}\" at {} has no place on axis \"{}\"", figure_id,
                 marker.label, marker.value, axis.label);
}

void check_edges(const std::vector<double>& edges, const Axis& axis, const std::string& id) {
  const bool ascending = edges.size() >= 2 && std::is_sorted(edges.begin(), edges.end()) &&
                         std::adjacent_find(edges.begin(), edges.end()) == edges.end();
  MODCAL_REQUIRE(ascending && std::isfinite(edges.front()) && std::isfinite(edges.back()) &&
                     (!axis.logarithmic || edges.front() > 0.0),
                 "figure \"{}\": the edges of a map along \"{}\" must be 2 or more ascending "
                 "numbers that the axis can show",
                 id, axis.label);
}

void check_map(const CategoryMap& map, const Panel& panel, const std::string& id) {
  check_edges(map.x_edges, panel.x, id);
  check_edges(map.y_edges, panel.y, id);
  MODCAL_REQUIRE(map.cells.size() == map.columns() * map.rows(),
                 "figure \"{}\": a map of {} columns and {} rows has {} cells", id, map.columns(),
                 map.rows(), map.cells.size());
  const auto categories = static_cast<int>(map.categories.size());
  for (const int cell : map.cells) {
    MODCAL_REQUIRE(cell >= -1 && cell < categories,
                   "figure \"{}\": category {} of a cell is none of the {} of its map", id, cell,
                   categories);
  }
}

}  // namespace

std::string Axis::text() const {
  return unit.empty() || unit == "1" ? label : fmt::format("{} [{}]", label, unit);
}

std::vector<const Series*> shown_series(const Panel& panel) {
  std::vector<const Series*> shown;
  for (const Series& series : panel.series) {
    if (!series.hidden) shown.push_back(&series);
  }
  return shown;
}

bool is_file_stem(std::string_view id) {
  return !id.empty() && std::all_of(id.begin(), id.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-';
  });
}

void check_figure(const Figure& figure) {
  MODCAL_REQUIRE(is_file_stem(figure.id),
                 "\"{}\" cannot name the files of a figure; use letters, digits, - and _",
                 figure.id);
  MODCAL_REQUIRE(figure.columns >= 1, "figure \"{}\" has {} columns; give 1 or more", figure.id,
                 figure.columns);
  MODCAL_REQUIRE(!figure.panels.empty(), "figure \"{}\" has no panel; give 1 or more", figure.id);
  for (const Panel& panel : figure.panels) {
    check_axis(panel.x, figure.id);
    check_axis(panel.y, figure.id);
    for (const Series& series : panel.series) check_series(series, figure.id);
    for (const Marker& marker : panel.markers) check_marker(marker, panel, figure.id);
    if (panel.map) check_map(*panel.map, panel, figure.id);
  }
}

}  // namespace modcal::report
