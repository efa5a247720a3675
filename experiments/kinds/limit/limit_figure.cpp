#include <cmath>
#include <functional>

#include "experiments/kinds/limit/limit_summary.hpp"

namespace modcal {
namespace {

using report::ColorRole;
using report::SeriesStyle;

report::Panel panel_of(const std::string& title, const std::string& unit) {
  report::Panel panel;
  panel.title = title;
  panel.x = {.label = "noise", .unit = "%", .logarithmic = true};
  panel.y = {.label = "error", .unit = unit, .logarithmic = true};
  return panel;
}

// Points of one parameter with their standard errors, and its bound. Without noise there is no
// place on the axis.
void add_parameter(const std::vector<LimitSummary>& levels, const std::string& parameter,
                   const std::string& title, const std::string& unit, report::Figure& figure) {
  report::Series points{
      .label = "joint likelihood", .style = SeriesStyle::kPoints, .color = ColorRole::kFirst};
  report::Series bound{.label = "bound", .color = ColorRole::kReference};
  for (const LimitSummary& level : levels) {
    const LimitRow* row = level.find(parameter);
    if (!row || !(row->rmse > 0.0) || !(level.level > 0.0)) continue;
    const double error = row->rmse / std::sqrt(2.0 * static_cast<double>(row->count));
    points.x.push_back(row->noise_percent);
    points.y.push_back(row->rmse);
    points.y_low.push_back(row->rmse - error);
    points.y_high.push_back(row->rmse + error);
    bound.x.push_back(row->noise_percent);
    bound.y.push_back(row->bound);
  }
  if (points.x.empty()) return;
  report::Panel panel = panel_of(title, unit);
  panel.series = {std::move(points), std::move(bound)};
  figure.panels.push_back(std::move(panel));
}

report::Series over_noise(const std::vector<LimitSummary>& levels, report::Series series,
                          double LimitSummary::*value) {
  for (const LimitSummary& level : levels) {
    if (!(level.*value > 0.0) || !(level.level > 0.0)) continue;
    series.x.push_back(100.0 * level.level);
    series.y.push_back(level.*value);
  }
  return series;
}

void add_median(const std::vector<LimitSummary>& levels, report::Figure& figure) {
  report::Panel panel = panel_of("f_n, median of the excited modes", "1");
  for (report::Series& series : std::vector{
           over_noise(levels,
                      {.label = "joint likelihood",
                      .style = SeriesStyle::kPoints,
                      .color = ColorRole::kFirst},
                      &LimitSummary::median_error),
           over_noise(levels, {.label = "bound, median mode", .color = ColorRole::kReference},
                      &LimitSummary::median_bound),
           over_noise(levels,
                      {.label = "spectral peak (the paper)",
                      .style = SeriesStyle::kPoints,
                      .color = ColorRole::kSecond},
                      &LimitSummary::paper_error)}) {
    if (!series.x.empty()) panel.series.push_back(std::move(series));
  }
  if (!panel.series.empty()) figure.panels.push_back(std::move(panel));
}

}  // namespace

report::Figure limit_figure(const std::vector<LimitSummary>& levels, const std::string& command) {
  report::Figure figure{.id = "calibration_limit_figure",
                        .title = "Calibration error against noise",
                        .caption =
                            "Points: RMSE over the seeds, bars: its standard error; line: "
                            "Cramér-Rao bound with the force unknown.",
                        .columns = 3,
                        .command = command};
  add_parameter(levels, "f0", "f0", "Hz", figure);
  add_parameter(levels, "B", "B", "1", figure);
  add_parameter(levels, "x_c", "x_c", "m", figure);
  add_parameter(levels, "damping", "damping factor", "1", figure);
  add_parameter(levels, "x_c, frequencies free", "x_c, frequencies free", "m", figure);
  add_parameter(levels, "gain", "sensor gain", "1", figure);
  add_parameter(levels, "delay", "sensor delay", "s", figure);
  add_parameter(levels, "corner", "sensor corner", "Hz", figure);
  add_median(levels, figure);
  return figure;
}

}  // namespace modcal
