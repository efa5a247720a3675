#include "experiments/report/figure_csv.hpp"

#include <algorithm>
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

std::vector<NamedColumn> columns_of(const Figure& figure) {
  std::vector<Block> blocks;
  for (const Panel& panel : figure.panels) {
    for (const Series& series : panel.series) {
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
  std::string text;
  std::size_t rows = 0;
  for (std::size_t j = 0; j < columns.size(); ++j) {
    text += (j == 0 ? "" : ",") + csv_field(columns[j].heading);
    rows = std::max(rows, columns[j].values->size());
  }
  text += '\n';
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < columns.size(); ++j) {
      if (j > 0) text += ',';
      if (i < columns[j].values->size()) text += csv_field((*columns[j].values)[i]);
    }
    text += '\n';
  }
  return text;
}

}  // namespace modcal::report
