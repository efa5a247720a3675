#include "experiments/kinds/sweep/sweep_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>

#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

report::Figure sweep_figure(const std::string& name, const std::vector<SweepRow>& rows,
                            const std::string& command) {
  using report::ColorRole;
  report::Figure figure{.id = name + "_figure",
                        .title = "Correlation of identified and true force against noise",
                        .caption =
                            "Median with the band from 10 % to 90 % of the draws; points: "
                            "published figures.",
                        .columns = 2,
                        .command = command};
  for (const std::string side : {"1", "2"}) {
    report::Series ours{.label = "median, 10-90 %", .style = report::SeriesStyle::kLineWithPoints};
    ours.color = side == "1" ? ColorRole::kFirst : ColorRole::kSecond;
    report::Series paper{
        .label = "paper", .style = report::SeriesStyle::kPoints, .color = ColorRole::kReference};
    for (const SweepRow& row : rows) {
      if (row.side != side) continue;
      ours.x.push_back(row.noise_percent);
      ours.y.push_back(row.median);
      ours.y_low.push_back(row.q10);
      ours.y_high.push_back(row.q90);
      if (!row.published_correlation) continue;
      paper.x.push_back(row.noise_percent);
      paper.y.push_back(*row.published_correlation);
    }
    report::Panel panel{.title = fmt::format("from R{}", side),
                        .x = {.label = "noise", .unit = "%"},
                        .y = {.label = "correlation R"},
                        .series = {std::move(ours)}};
    if (!paper.x.empty()) panel.series.push_back(std::move(paper));
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

std::string series_name(const std::string& side) {
  if (side == "1" || side == "2") return "water level, R" + side;
  if (side == "linear_limit") return "linear limit (oracle Wiener)";
  if (side == "model") return "model-based";
  return side;
}

// Every estimate in one panel, with the better side of the published figures.
report::Figure comparison_figure(const std::string& name, const std::vector<SweepRow>& rows,
                                 const std::string& command) {
  using report::ColorRole;
  static constexpr ColorRole kColors[] = {ColorRole::kFirst, ColorRole::kSecond, ColorRole::kThird,
                                          ColorRole::kFourth, ColorRole::kFifth};
  report::Figure figure{.id = name + "_figure",
                        .title = "Correlation of identified and true force against noise",
                        .caption = "Mean with the band from 10 % to 90 % of the draws.",
                        .columns = 2,
                        .command = command};
  std::vector<std::string> sides;
  std::map<double, double> paper;
  for (const SweepRow& row : rows) {
    if (sides.empty() || sides.back() != row.side) sides.push_back(row.side);
    if (!row.published_correlation) continue;
    double& best = paper[row.noise_percent];
    best = std::max(best, *row.published_correlation);
  }
  const auto panel_of = [&](const std::string& title, std::vector<double> SweepRow::*values) {
    report::Panel panel{
        .title = title, .x = {.label = "noise", .unit = "%"}, .y = {.label = "correlation R"}};
    for (std::size_t s = 0; s < sides.size(); ++s) {
      report::Series series{.label = series_name(sides[s]),
                            .style = report::SeriesStyle::kLineWithPoints,
                            .color = kColors[s % std::size(kColors)]};
      for (const SweepRow& row : rows) {
        if (row.side != sides[s] || std::isnan(mean_of(row.*values))) continue;
        series.x.push_back(row.noise_percent);
        series.y.push_back(mean_of(row.*values));
        series.y_low.push_back(quantile(row.*values, 0.1));
        series.y_high.push_back(quantile(row.*values, 0.9));
      }
      if (!series.x.empty()) panel.series.push_back(std::move(series));
    }
    return panel;
  };
  report::Panel windows = panel_of("short windows", &SweepRow::correlation);
  if (!paper.empty()) {
    report::Series series{.label = "paper, better side",
                          .style = report::SeriesStyle::kPoints,
                          .color = ColorRole::kReference};
    for (const auto& [noise, value] : paper) {
      series.x.push_back(noise);
      series.y.push_back(value);
    }
    windows.series.push_back(std::move(series));
  }
  figure.panels.push_back(std::move(windows));
  report::Panel whole = panel_of("long window", &SweepRow::whole);
  if (!whole.series.empty()) figure.panels.push_back(std::move(whole));
  return figure;
}

bool compares_estimators(const std::vector<SweepRow>& rows) {
  return std::any_of(rows.begin(), rows.end(),
                     [](const SweepRow& row) { return row.side != "1" && row.side != "2"; });
}

}  // namespace

report::Figure correlation_figure(const std::string& name, const std::vector<SweepRow>& rows,
                                  const std::string& command) {
  return compares_estimators(rows) ? comparison_figure(name, rows, command)
                                   : sweep_figure(name, rows, command);
}

}  // namespace modcal
