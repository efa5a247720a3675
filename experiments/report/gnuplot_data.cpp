// The numbers that a gnuplot script draws.
#include <fmt/format.h>

#include <cmath>

#include "experiments/report/gnuplot_sheet.hpp"

namespace modcal::report {
namespace {

std::string number(double value) {
  return std::isnan(value) ? std::string("NaN") : fmt::format("{:.9g}", value);
}

// Cells of one category, neighbours of a row put together: middle, left, right, low, high.
std::string category_data(const CategoryMap& map, std::size_t category) {
  std::string text;
  const std::size_t columns = map.columns();
  const auto is_here = [&](std::size_t row, std::size_t column) {
    return map.cells[row * columns + column] == static_cast<int>(category);
  };
  for (std::size_t row = 0; row < map.rows(); ++row) {
    for (std::size_t begin = 0; begin < columns; ++begin) {
      if (!is_here(row, begin)) continue;
      std::size_t end = begin + 1;
      while (end < columns && is_here(row, end)) ++end;
      const double left = map.x_edges[begin], right = map.x_edges[end];
      const double low = map.y_edges[row], high = map.y_edges[row + 1];
      text += fmt::format("{} {} {} {} {} {}\n", number(0.5 * (left + right)),
                          number(0.5 * (low + high)), number(left), number(right), number(low),
                          number(high));
      begin = end;
    }
  }
  return text;
}

}  // namespace

std::string gnuplot_data(const DrawnFigure& figure) {
  std::string text;
  for (const DrawnPanel& panel : figure.panels) {
    const CategoryMap* map = panel.source->map ? &*panel.source->map : nullptr;
    for (std::size_t i = 0; map != nullptr && i < map->categories.size(); ++i) {
      if (!has_cells(*map, i)) continue;
      if (!text.empty()) text += "\n\n";
      text += category_data(*map, i);
    }
    for (const DrawnSeries& drawn : panel.series) {
      if (!drawn.has_values() || drawn.source->hidden) continue;
      if (!text.empty()) text += "\n\n";
      for (std::size_t i = 0; i < drawn.x.size(); ++i) {
        text += number(drawn.x[i]) + ' ' + number(drawn.y[i]);
        if (!drawn.low.empty()) text += ' ' + number(drawn.low[i]) + ' ' + number(drawn.high[i]);
        text += '\n';
      }
    }
  }
  return text;
}

}  // namespace modcal::report
