#include "experiments/report/figure_csv.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "experiments/report/csv_field.hpp"

namespace modcal::report {
namespace {

struct NamedColumn {
  std::string heading;
  const std::vector<double>* values;
};

// Series over the same abscissae.
struct Block {
  NamedColumn x;
  std::vector<NamedColumn> columns;
};

std::string name_of(const Panel& panel, const Series& series) {
  if (panel.title.empty()) return series.label;
  return series.label.empty() ? panel.title : panel.title + ": " + series.label;
}

Block& block_for(std::vector<Block>& blocks, const Panel& panel, const Series& series) {
  const std::string heading = panel.x.text();
  const auto found = std::find_if(blocks.begin(), blocks.end(), [&](const Block& block) {
    return block.x.heading == heading && *block.x.values == series.x;
  });
  if (found != blocks.end()) return *found;
  return blocks.emplace_back(Block{{heading, &series.x}, {}});
}

// One row a cell: its middle (the geometric one on a logarithmic axis) and its category.
struct MapColumns {
  std::vector<std::string> headings;
  std::vector<std::array<std::string, 3>> rows;
};

double middle(const std::vector<double>& edges, std::size_t i, const Axis& axis) {
  return axis.logarithmic ? std::sqrt(edges[i] * edges[i + 1]) : 0.5 * (edges[i] + edges[i + 1]);
}

MapColumns map_columns(const Figure& figure) {
  MapColumns columns;
  for (const Panel& panel : figure.panels) {
    if (!panel.map) continue;
    const CategoryMap& map = *panel.map;
    columns.headings = {panel.x.text(), panel.y.text(),
                        panel.title.empty() ? "category" : panel.title};
    for (std::size_t j = 0; j < map.rows(); ++j) {
      for (std::size_t i = 0; i < map.columns(); ++i) {
        const int cell = map.cells[j * map.columns() + i];
        columns.rows.push_back(
            {csv_field(middle(map.x_edges, i, panel.x)), csv_field(middle(map.y_edges, j, panel.y)),
             cell < 0 ? "" : csv_field(map.categories[static_cast<std::size_t>(cell)].label)});
      }
    }
  }
  return columns;
}

std::vector<NamedColumn> columns_of(const Figure& figure) {
  std::vector<Block> blocks;
  for (const Panel& panel : figure.panels) {
    for (const Series* shown : shown_series(panel)) {
      const Series& series = *shown;
      Block& block = block_for(blocks, panel, series);
      const auto add = [&](const char* suffix, const std::vector<double>& values) {
        const Axis heading{.label = name_of(panel, series) + suffix, .unit = panel.y.unit};
        block.columns.push_back({heading.text(), &values});
      };
      add("", series.y);
      if (series.y_low.empty()) continue;
      add(" low", series.y_low);
      add(" high", series.y_high);
    }
  }
  std::vector<NamedColumn> columns;
  for (Block& block : blocks) {
    columns.push_back(block.x);
    std::move(block.columns.begin(), block.columns.end(), std::back_inserter(columns));
  }
  return columns;
}

}  // namespace

std::string figure_csv(const Figure& figure) {
  const std::vector<NamedColumn> columns = columns_of(figure);
  const MapColumns map = map_columns(figure);
  std::string text;
  for (const std::string& heading : map.headings) text += csv_field(heading) + ',';
  std::size_t rows = map.rows.size();
  for (std::size_t j = 0; j < columns.size(); ++j) {
    text += (j == 0 ? "" : ",") + csv_field(columns[j].heading);
    rows = std::max(rows, columns[j].values->size());
  }
  text += '\n';
  for (std::size_t i = 0; i < rows; ++i) {
    if (!map.headings.empty()) {
      text += i < map.rows.size() ? fmt::format("{},", fmt::join(map.rows[i], ",")) : ",,,";
    }
    for (std::size_t j = 0; j < columns.size(); ++j) {
      if (j > 0) text += ',';
      if (i < columns[j].values->size()) text += csv_field((*columns[j].values)[i]);
    }
    text += '\n';
  }
  return text;
}

}  // namespace modcal::report
