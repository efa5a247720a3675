#include "experiments/report/figure.hpp"

#include <algorithm>
#include <cmath>

#include "experiments/report/encoding.hpp"
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

struct CsvColumn {
  std::string heading;
  std::size_t size;
  std::function<std::string(std::size_t)> field;
};

CsvColumn column_of(const Axis& heading, const std::vector<double>& values) {
  return {heading.text(), values.size(), [&values](std::size_t i) { return csv_field(values[i]); }};
}

// Series over the same abscissae, these in front.
struct ColumnGroup {
  const std::vector<double>* x;
  std::vector<CsvColumn> columns;
};

// several: panels, whose series may have the same labels.
std::string name_of(const Panel& panel, const Series& series, bool several) {
  if (panel.title.empty()) {
    if (series.label.empty()) return panel.y.label;
    return several ? panel.y.label + ": " + series.label : series.label;
  }
  return series.label.empty() ? panel.title : panel.title + ": " + series.label;
}

ColumnGroup& group_for(std::vector<ColumnGroup>& groups, const Panel& panel, const Series& series) {
  const auto found = std::find_if(groups.begin(), groups.end(), [&](const ColumnGroup& group) {
    return group.columns.front().heading == panel.x.text() && *group.x == series.x;
  });
  if (found != groups.end()) return *found;
  return groups.emplace_back(ColumnGroup{&series.x, {column_of(panel.x, series.x)}});
}

double middle(const std::vector<double>& edges, std::size_t i, const Axis& axis) {
  return axis.logarithmic ? std::sqrt(edges[i] * edges[i + 1]) : 0.5 * (edges[i] + edges[i + 1]);
}

// One row a cell: its middle (the geometric one on a logarithmic axis) and its category.
std::vector<CsvColumn> map_columns(const Panel& panel) {
  const CategoryMap& map = *panel.map;
  const std::size_t n = map.columns();
  const auto category = [&map](std::size_t i) {
    const int cell = map.cells[i];
    return cell < 0 ? "" : csv_field(map.categories[static_cast<std::size_t>(cell)].label);
  };
  return {{panel.x.text(), map.cells.size(),
           [&, n](std::size_t i) { return csv_field(middle(map.x_edges, i % n, panel.x)); }},
          {panel.y.text(), map.cells.size(),
           [&, n](std::size_t i) { return csv_field(middle(map.y_edges, i / n, panel.y)); }},
          {panel.title.empty() ? "category" : panel.title, map.cells.size(), category}};
}

std::vector<CsvColumn> columns_of(const Figure& figure) {
  std::vector<CsvColumn> columns;
  std::vector<ColumnGroup> groups;
  const bool several = figure.panels.size() > 1;
  for (const Panel& panel : figure.panels) {
    if (panel.map) columns = map_columns(panel);
    for (const Series* series : shown_series(panel)) {
      ColumnGroup& group = group_for(groups, panel, *series);
      const auto add = [&](const char* suffix, const std::vector<double>& values) {
        group.columns.push_back(column_of(
            {.label = name_of(panel, *series, several) + suffix, .unit = panel.y.unit}, values));
      };
      add("", series->y);
      if (series->y_low.empty()) continue;
      add(" low", series->y_low);
      add(" high", series->y_high);
    }
  }
  for (const ColumnGroup& group : groups) {
    columns.insert(columns.end(), group.columns.begin(), group.columns.end());
  }
  return columns;
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

const Ink& ink_of(ColorRole role) {
  static constexpr std::array<Ink, kColorRoles> kInks = {{
      {"reference", "#1a1a1a", "#f0f0f0", "○", "open_circle", 6},
      {"first", "#0072b2", "#4fa8dc", "●", "circle", 7},
      {"second", "#d55e00", "#f08030", "■", "square", 5},
      {"third", "#009e73", "#2cc295", "▲", "triangle", 9},
      {"fourth", "#cc79a7", "#e095c0", "◆", "diamond", 13},
      {"fifth", "#e69f00", "#f0b030", "▼", "inverted_triangle", 11},
      {"sixth", "#56b4e9", "#86ccf2", "□", "open_square", 4},
      {"muted", "#8a8a8a", "#8f8f8f", "●", "circle", 7},
      {"seventh", "#0072b2", "#4fa8dc", "○", "open_circle", 6},
      {"eighth", "#d55e00", "#f08030", "□", "open_square", 4},
      {"ninth", "#009e73", "#2cc295", "△", "open_triangle", 8},
      {"tenth", "#cc79a7", "#e095c0", "◇", "open_diamond", 12},
      {"eleventh", "#e69f00", "#f0b030", "▽", "open_inverted_triangle", 10},
      {"twelfth", "#56b4e9", "#86ccf2", "■", "square", 5},
  }};
  return kInks.at(static_cast<std::size_t>(role));
}

std::string figure_csv(const Figure& figure) {
  const std::vector<CsvColumn> columns = columns_of(figure);
  std::vector<std::string> headings;
  std::size_t rows = 0;
  for (const CsvColumn& column : columns) {
    headings.push_back(column.heading);
    rows = std::max(rows, column.size);
  }
  return csv_text(headings, rows, [&columns](std::size_t i, std::size_t j) {
    return i < columns[j].size ? columns[j].field(i) : std::string();
  });
}

}  // namespace modcal::report
