// Table, figures and JSON of an identification.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "experiments/kinds/identify/identify_study.hpp"

namespace modcal {
namespace {

using Json = nlohmann::ordered_json;
using report::ColorRole;
using report::SeriesStyle;

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

bool in_truth(const IdentifyOutcome& outcome, std::size_t number) {
  return number <= outcome.truth->basis.size();
}

}  // namespace

std::string identification_json(const IdentifyOutcome& outcome) {
  Json modes = Json::array();
  for (const auto& [number, mode] : outcome.found.modes) {
    const bool known = in_truth(outcome, number);
    modes.push_back(
        {{"n", number},
         {"f_hz", mode.pole.frequency},
         {"f_sd_hz", number_or_null(mode.deviation.frequency)},
         {"zeta", mode.pole.damping_ratio},
         {"zeta_sd", number_or_null(mode.deviation.damping_ratio)},
         {"f_true_hz", known ? Json(outcome.truth->basis.frequency(number - 1)) : Json()},
         {"zeta_true", known ? Json(outcome.truth->basis.zeta[number - 1]) : Json()}});
  }
  Json document = {{"modes", std::move(modes)},
                   {"missing", outcome.found.missing},
                   {"deviations_are_error_bars", outcome.found.full_rank},
                   {"noise_in_band_n", outcome.found.noise},
                   {"converged", outcome.found.converged}};
  if (outcome.law) {
    document["stiff_string_law"] = {
        {"f0_hz", outcome.law->fundamental},
        {"B", outcome.law->inharmonicity},
        {"f0_sd_hz", number_or_null(outcome.law->fundamental_deviation)},
        {"B_sd", number_or_null(outcome.law->inharmonicity_deviation)}};
  }
  return document.dump(1) + "\n";
}

report::Table identified_modes_table(const IdentifyOutcome& outcome, const std::string& command) {
  report::Table table{
      .id = "modes",
      .title = "Identified modes",
      .caption =
          outcome.found.full_rank
              ? "Deviations are the Cramér–Rao bound of the fit."
              : "Deviations are the spread over the orders of the realization: no error bars.",
      .columns = {{.key = "n", .name = "mode"},
                  {.key = "f", .name = "frequency", .unit = "Hz", .format = "{:.7g}"},
                  {.key = "f_sd", .name = "its deviation", .unit = "Hz", .format = "{:.2g}"},
                  {.key = "f_true", .name = "true frequency", .unit = "Hz", .format = "{:.7g}"},
                  {.key = "zeta", .name = "damping ratio"},
                  {.key = "zeta_sd", .name = "its deviation", .format = "{:.2g}"},
                  {.key = "zeta_true", .name = "true damping ratio"}},
      .command = command};
  for (const auto& [number, mode] : outcome.found.modes) {
    std::vector<report::Cell> row = {static_cast<std::int64_t>(number), mode.pole.frequency,
                                     mode.deviation.frequency};
    const bool known = in_truth(outcome, number);
    row.push_back(known ? report::Cell(outcome.truth->basis.frequency(number - 1))
                        : report::Cell());
    row.emplace_back(mode.pole.damping_ratio);
    row.emplace_back(mode.deviation.damping_ratio);
    row.push_back(known ? report::Cell(outcome.truth->basis.zeta[number - 1]) : report::Cell());
    table.rows.push_back(std::move(row));
  }
  return table;
}

report::Figure stabilization_figure(const IdentifyOutcome& outcome, const std::string& command) {
  report::Series moving{
      .label = "moves with the order", .style = SeriesStyle::kPoints, .color = ColorRole::kMuted};
  report::Series stable{.label = "stable", .style = SeriesStyle::kPoints};
  for (const StabilizationPoint& point : outcome.found.diagram) {
    report::Series& series = point.stable_orders > 1 ? stable : moving;
    series.x.push_back(point.pole.frequency);
    series.y.push_back(static_cast<double>(point.order));
  }
  return {.id = "stabilization",
          .title = "Stabilization diagram",
          .caption = "Poles of the realizations; a mode stays where it is when the order grows.",
          .panels = {{.x = {.label = "frequency", .unit = "Hz"},
                      .y = {.label = "order"},
                      .series = {std::move(moving), std::move(stable)}}},
          .command = command};
}

report::Figure identified_errors_figure(const IdentifyOutcome& outcome,
                                        const std::string& command) {
  report::Series errors{.label = "identified minus true", .style = SeriesStyle::kPoints};
  for (const auto& [number, mode] : outcome.found.modes) {
    if (!in_truth(outcome, number)) continue;
    const double truth = outcome.truth->basis.frequency(number - 1);
    const double error = mode.pole.frequency / truth - 1.0;
    const double deviation = mode.deviation.frequency / truth;
    errors.x.push_back(static_cast<double>(number));
    errors.y.push_back(error);
    errors.y_low.push_back(error - deviation);
    errors.y_high.push_back(error + deviation);
  }
  return {.id = "frequency_errors",
          .title = "Errors of the identified frequencies",
          .caption = "Bars: one standard deviation to either side.",
          .panels = {{.x = {.label = "mode"},
                      .y = {.label = "relative error of the frequency"},
                      .series = {std::move(errors)},
                      .markers = {{.direction = report::Marker::Direction::kHorizontal}}}},
          .command = command};
}

}  // namespace modcal
