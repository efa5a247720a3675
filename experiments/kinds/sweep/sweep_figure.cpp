// Correlation against noise, drawn.
#include <algorithm>

#include "experiments/kinds/sweep/sweep.hpp"

namespace modcal {
namespace {

using report::ColorRole;
using report::SeriesStyle;

report::Panel noise_panel(std::string title) {
  return {.title = std::move(title),
          .x = {.label = "noise", .unit = "%"},
          .y = {.label = "correlation R"}};
}

std::vector<report::Panel> side_panels(const std::vector<SweepRow>& rows) {
  std::vector<report::Panel> panels;
  for (const std::string side : {"1", "2"}) {
    report::Series ours{.label = "median, 10-90 %", .style = SeriesStyle::kLineWithPoints};
    report::Series paper{
        .label = "paper", .style = SeriesStyle::kPoints, .color = ColorRole::kReference};
    for (const SweepRow& row : rows) {
      if (row.side != side) continue;
      add_band(ours, row.noise_percent, Spread::of(row.correlation));
      if (row.published_correlation) {
        paper.add(row.noise_percent, *row.published_correlation);
      }
    }
    panels.push_back(noise_panel("from R" + side));
    panels.back().series = {std::move(ours)};
    add_drawn(panels.back(), std::move(paper));
  }
  return panels;
}

std::string series_name(const std::string& side) {
  static const std::map<std::string, std::string> kNames = {
      {"1", "water level, R1"},
      {"2", "water level, R2"},
      {"linear_limit", "linear limit (oracle Wiener)"},
      {"model", "model-based"}};
  const auto found = kNames.find(side);
  return found == kNames.end() ? side : found->second;
}

report::Panel estimator_panel(const std::string& title, const std::vector<SweepRow>& rows,
                              Sample SweepRow::*sample) {
  static constexpr ColorRole kColors[] = {ColorRole::kFirst, ColorRole::kSecond, ColorRole::kThird,
                                          ColorRole::kFourth, ColorRole::kFifth};
  report::Panel panel = noise_panel(title);
  std::size_t sides = 0;
  for (auto row = rows.begin(); row != rows.end(); ++sides) {
    const std::string& side = row->side;
    report::Series series{.label = series_name(side),
                          .style = SeriesStyle::kLineWithPoints,
                          .color = kColors[sides % std::size(kColors)]};
    for (; row != rows.end() && row->side == side; ++row) {
      const Sample& found = (*row).*sample;
      if (std::isnan(found.known_mean())) continue;
      add_band(series, row->noise_percent, {found.known_mean(), found.q10(), found.q90()});
    }
    add_drawn(panel, std::move(series));
  }
  return panel;
}

// Every estimate in one panel, with the better side of the published figures.
std::vector<report::Panel> comparison_panels(const std::vector<SweepRow>& rows) {
  std::vector<report::Panel> panels = {
      estimator_panel("short windows", rows, &SweepRow::correlation),
      estimator_panel("long window", rows, &SweepRow::whole)};
  std::map<double, double> paper;
  for (const SweepRow& row : rows) {
    if (!row.published_correlation) continue;
    double& best = paper[row.noise_percent];
    best = std::max(best, *row.published_correlation);
  }
  report::Series published{
      .label = "paper, better side", .style = SeriesStyle::kPoints, .color = ColorRole::kReference};
  for (const auto& [noise, value] : paper) published.add(noise, value);
  add_drawn(panels[0], std::move(published));
  if (panels[1].series.empty()) panels.pop_back();
  return panels;
}

}  // namespace

report::Figure correlation_figure(const std::string& name, const std::vector<SweepRow>& rows) {
  const bool compares_estimators = std::any_of(rows.begin(), rows.end(), [](const SweepRow& row) {
    return row.side != "1" && row.side != "2";
  });
  return {.id = name + "_figure",
          .title = "Correlation of identified and true force against noise",
          .caption = compares_estimators
                         ? "Mean with the band from 10 % to 90 % of the draws."
                         : "Median with the band from 10 % to 90 % of the draws; points: "
                           "published figures.",
          .columns = 2,
          .panels = compares_estimators ? comparison_panels(rows) : side_panels(rows)};
}

}  // namespace modcal
