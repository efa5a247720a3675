#include "experiments/report/figure_csv.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "experiments/report/encoding.hpp"

namespace modcal::report {
namespace {

struct CsvColumn {
  std::string heading;
  std::size_t size;
  std::function<std::string(std::size_t)> field;
};

CsvColumn column_of(const Axis& heading, const std::vector<double>& values) {
  return {heading.text(), values.size(), [&values](std::size_t i) { return csv_field(values[i]); }};
}

// Series over the same abscissae, these in front.
struct Block {
  const std::vector<double>* x;
  std::vector<CsvColumn> columns;
};

std::string name_of(const Panel& panel, const Series& series) {
  if (panel.title.empty()) return series.label;
  return series.label.empty() ? panel.title : panel.title + ": " + series.label;
}

Block& block_for(std::vector<Block>& blocks, const Panel& panel, const Series& series) {
  const auto found = std::find_if(blocks.begin(), blocks.end(), [&](const Block& block) {
    return block.columns.front().heading == panel.x.text() && *block.x == series.x;
  });
  if (found != blocks.end()) return *found;
  return blocks.emplace_back(Block{&series.x, {column_of(panel.x, series.x)}});
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
  std::vector<Block> blocks;
  for (const Panel& panel : figure.panels) {
    if (panel.map) columns = map_columns(panel);
    for (const Series* series : shown_series(panel)) {
      Block& block = block_for(blocks, panel, *series);
      const auto add = [&](const char* suffix, const std::vector<double>& values) {
        block.columns.push_back(
            column_of({.label = name_of(panel, *series) + suffix, .unit = panel.y.unit}, values));
      };
      add("", series->y);
      if (series->y_low.empty()) continue;
      add(" low", series->y_low);
      add(" high", series->y_high);
    }
  }
  for (const Block& block : blocks) {
    columns.insert(columns.end(), block.columns.begin(), block.columns.end());
  }
  return columns;
}

}  // namespace

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
