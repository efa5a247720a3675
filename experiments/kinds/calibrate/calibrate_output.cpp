// Tables, figures and JSON of a calibration.
#include <cmath>
#include <nlohmann/json.hpp>

#include "experiments/kinds/calibrate/calibrate_covariance.hpp"
#include "experiments/kinds/calibrate/calibrate_fit_stages.hpp"
#include "experiments/kinds/calibrate/calibrate_study.hpp"
#include "libcalib/parameters/unknown_name.hpp"

namespace modcal {
namespace {

using Json = nlohmann::ordered_json;
using report::ColorRole;
using report::SeriesStyle;

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

double refined_frequency(const CalibrationOutcome& outcome, std::size_t n) {
  return outcome.refined.basis.frequency(n - 1);
}

Json misfit_json(const PriorMisfit& misfit) {
  return {{"chi2", number_or_null(misfit.chi2)},
          {"count", misfit.count},
          {"contradicted", misfit.contradicted()},
          {"farthest", misfit.farthest},
          {"deviations", number_or_null(misfit.deviations)}};
}

Json modes_json(const CalibrationOutcome& outcome) {
  Json modes = Json::array();
  for (const CalibratedMode& mode : outcome.result.modes) {
    const Json truth = outcome.true_frequencies.empty()
                           ? Json(nullptr)
                           : Json(outcome.true_frequencies[mode.number - 1]);
    modes.push_back({{"n", mode.number},
                     {"f_true_hz", truth},
                     {"f_initial_hz", mode.initial_frequency},
                     {"f_hz", refined_frequency(outcome, mode.number)},
                     {"excited", mode.excited},
                     {"searched", mode.searched},
                     {"shape_at_contact", mode.shape}});
    if (!outcome.result.continuation) continue;
    const ModeVerdict& verdict = outcome.result.continuation->modes[mode.number - 1];
    modes.back()["relative_sd"] = number_or_null(verdict.deviation);
    modes.back()["source"] = name_of(verdict.source);
    modes.back()["reason"] = name_of(verdict.reason);
    modes.back()["data_sd"] = number_or_null(verdict.data_deviation);
    modes.back()["law"] = name_of(verdict.tie);
    modes.back()["beyond_law"] = number_or_null(verdict.departure);
  }
  return modes;
}

Json parameters_json(const std::vector<CalibratedParameter>& found) {
  Json parameters = Json::array();
  for (const CalibratedParameter& parameter : found) {
    parameters.push_back({{"name", parameter.name},
                          {"unit", parameter.unit},
                          {"initial", parameter.initial},
                          {"final", parameter.final},
                          {"at_bound", parameter.at_bound},
                          {"sd", number_or_null(parameter.deviation)},
                          {"meaning", meaning_of_unknown(parameter.name)}});
  }
  return parameters;
}

Json continuation_json(const ContinuationResult& found,
                       const std::vector<double>& contact_deviations) {
  return {{"right", found.right},
          {"fits", found.fits},
          {"chi2", number_or_null(found.chi2)},
          {"chi2_sd", number_or_null(found.chi2_deviation)},
          {"law_chi2", number_or_null(found.law.chi2)},
          {"law_accepted", found.law.accepted},
          {"priors", misfit_json(found.priors)},
          {"law_priors", misfit_json(found.law.priors)},
          {"law_width", number_or_null(found.law_width)},
          {"f0_sd_hz", number_or_null(found.law.deviation[0])},
          {"B_sd", number_or_null(found.law.deviation[1])},
          {"x_c_sd_m", number_or_null(found.contact_deviation)},
          {"damping_sd", number_or_null(found.damping_deviation)},
          {"noise_left_n", number_or_null(found.noise[0])},
          {"noise_right_n", number_or_null(found.noise[1])},
          {"restarts", found.restarts},
          {"moved_modes", found.moved_modes},
          {"covariance", covariance_json(found.covariance)},
          {"law_covariance", covariance_json(found.law.covariance)},
          {"stages", stages_json(found.stages)},
          {"x_c_sd_of_strokes_m", contact_deviations}};
}

}  // namespace

std::string calibration_json(const CalibrationOutcome& outcome) {
  const OptimizationResult& search = outcome.result.search;
  Json trace = Json::array();
  for (const TracePoint& point : search.trace) {
    trace.push_back({point.evaluations, number_or_null(point.value)});
  }
  Json document = {
      {"modes", modes_json(outcome)},
      {"loops", search.loops},
      {"searched_by_loop", search.searched},
      {"evaluations", search.evaluations},
      {"seconds", search.seconds},
      {"stop_reason", name_of(search.stop)},
      {"objective_initial", number_or_null(search.initial_value)},
      {"objective", number_or_null(search.value)},
      {"median_relative_error_excited", number_or_null(median_relative_error(outcome))},
      {"parameters", parameters_json(outcome.result.parameters)},
      {"trace", std::move(trace)}};
  if (outcome.law) {
    document["stiff_string_law"] = {
        {"f0_hz", outcome.law->fundamental},
        {"B", outcome.law->inharmonicity},
        {"f0_sd_hz", number_or_null(outcome.law->fundamental_deviation)},
        {"B_sd", number_or_null(outcome.law->inharmonicity_deviation)}};
  }
  if (outcome.result.continuation) {
    document["continuation"] =
        continuation_json(*outcome.result.continuation, outcome.result.contact_deviations);
  }
  return document.dump(1) + "\n";
}

report::Table search_table(const CalibrationOutcome& outcome, const std::string& command) {
  const OptimizationResult& search = outcome.result.search;
  const double error = median_relative_error(outcome);
  return {
      .id = "search",
      .title = "Search",
      .columns = {{.key = "stop_reason", .name = "ended because"},
                  {.key = "evaluations"},
                  {.key = "loops"},
                  {.key = "seconds", .unit = "s"},
                  {.key = "objective_initial", .name = "objective, initial"},
                  {.key = "objective", .name = "objective, final"},
                  {.key = "median_relative_error_excited",
                   .name = "median relative error, excited modes",
                   .format = "{:.3g}"}},
      .rows = {{std::string(name_of(search.stop)), search.evaluations, search.loops, search.seconds,
                std::isfinite(search.initial_value) || !outcome.result.continuation
                    ? report::Cell(search.initial_value)
                    : report::Cell(),
                search.value, std::isfinite(error) ? report::Cell(error) : report::Cell()}},
      .command = command};
}

report::Table parameter_table(const CalibrationOutcome& outcome, const std::string& command) {
  report::Table table{.id = "parameters",
                      .title = "Parameters",
                      .columns = {{.key = "name"},
                                  {.key = "initial", .format = "{:.8g}"},
                                  {.key = "final", .format = "{:.8g}"},
                                  {.key = "sd", .name = "standard deviation", .format = "{:.3g}"},
                                  {.key = "unit"},
                                  {.key = "meaning"}},
                      .command = command};
  for (const CalibratedParameter& parameter : outcome.result.parameters) {
    if (parameter.name.starts_with("f_")) continue;
    report::Cell sd;
    if (std::isfinite(parameter.deviation)) sd = parameter.deviation;
    table.rows.push_back({parameter.name, parameter.initial, parameter.final, sd, parameter.unit,
                          std::string(meaning_of_unknown(parameter.name))});
  }
  return table;
}

report::Table mode_table(const CalibrationOutcome& outcome, const std::string& command) {
  report::Table table{
      .id = "modes",
      .title = "Modal frequencies",
      .columns = {{.key = "n"},
                  {.key = "f_true_hz", .name = "true", .unit = "Hz", .format = "{:.3f}"},
                  {.key = "f_initial_hz", .name = "initial", .unit = "Hz", .format = "{:.3f}"},
                  {.key = "f_hz", .name = "refined", .unit = "Hz", .format = "{:.3f}"},
                  {.key = "relative_error", .name = "relative error", .format = "{:.2e}"},
                  {.key = "relative_sd", .name = "relative sd", .format = "{:.1e}"},
                  {.key = "data_sd", .name = "by its data alone", .format = "{:.1e}"},
                  {.key = "verdict"},
                  {.key = "excited"},
                  {.key = "shape_at_contact",
                   .name = "mode shape at the contact",
                   .format = "{:.3f}"}},
      .command = command};
  for (const CalibratedMode& mode : outcome.result.modes) {
    const double refined = refined_frequency(outcome, mode.number);
    report::Cell truth, error, deviation, data_deviation, verdict;
    if (outcome.result.continuation) {
      const ModeVerdict& found = outcome.result.continuation->modes[mode.number - 1];
      deviation = found.deviation;
      data_deviation = found.data_deviation;
      verdict = verdict_text(found);
    }
    if (!outcome.true_frequencies.empty()) {
      truth = outcome.true_frequencies[mode.number - 1];
      error = refined / outcome.true_frequencies[mode.number - 1] - 1.0;
    }
    table.rows.push_back({mode.number, truth, mode.initial_frequency, refined, error, deviation,
                          data_deviation, verdict, mode.excited, mode.shape});
  }
  return table;
}

report::Figure objective_figure(const FigureOptions& options, const CalibrationOutcome& outcome) {
  report::Figure figure{.id = options.id, .title = options.title, .columns = 3};
  figure.caption =
      "First loop over the candidates; dotted: true frequency; square: the candidate "
      "chosen in the last loop.";
  for (const CoordinateScan& scan : outcome.result.search.scans) {
    if (scan.loop != 1) continue;
    const CalibratedParameter& parameter = outcome.result.parameters[scan.variable];
    if (!parameter.name.starts_with("f_")) continue;
    const auto n = static_cast<std::size_t>(std::stoul(parameter.name.substr(2)));
    if (n > static_cast<std::size_t>(options.modes)) continue;
    report::Panel panel;
    panel.title = fmt::format("mode {}", n);
    panel.x = {.label = fmt::format("f_{}", n), .unit = "Hz"};
    panel.y = {.label = "C", .unit = "N"};
    panel.series.push_back({.label = "objective, first loop",
                            .x = scan.candidates,
                            .y = scan.values,
                            .style = SeriesStyle::kLineWithPoints});
    for (const CoordinateScan& last : outcome.result.search.scans) {
      if (last.variable != scan.variable || last.loop == 1) continue;
      const auto best = std::min_element(last.values.begin(), last.values.end());
      panel.series.push_back({.label = fmt::format("chosen, loop {}", last.loop),
                              .x = {last.chosen},
                              .y = {*best},
                              .style = SeriesStyle::kPoints,
                              .color = ColorRole::kSecond});
    }
    if (!outcome.true_frequencies.empty()) {
      panel.markers.push_back({.value = outcome.true_frequencies[n - 1], .label = "true"});
    }
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

report::Figure frequency_error_figure(const FigureOptions& options,
                                      const CalibrationOutcome& outcome) {
  report::Figure figure{.id = options.id, .title = options.title, .columns = 1};
  figure.caption = "Open points: modes that the contact does not excite.";
  report::Series absolute[2], relative[2], shape[2];
  for (const CalibratedMode& mode : outcome.result.modes) {
    const std::size_t group = mode.excited ? 0 : 1;
    const auto n = static_cast<double>(mode.number);
    shape[group].x.push_back(n);
    shape[group].y.push_back(std::abs(mode.shape));
    if (outcome.true_frequencies.empty()) continue;
    const double truth = outcome.true_frequencies[mode.number - 1];
    const double error = refined_frequency(outcome, mode.number) - truth;
    absolute[group].x.push_back(n);
    absolute[group].y.push_back(std::abs(error));
    relative[group].x.push_back(n);
    relative[group].y.push_back(100.0 * std::abs(error) / truth);
  }
  const auto add = [&figure](report::Series* series, report::Axis y) {
    report::Panel panel;
    panel.x = {.label = "mode number n"};
    panel.y = std::move(y);
    for (int group = 0; group < 2; ++group) {
      if (series[group].x.empty()) continue;
      series[group].label = group == 0 ? "excited" : "blind";
      series[group].style = SeriesStyle::kPoints;
      series[group].color = group == 0 ? ColorRole::kFirst : ColorRole::kSecond;
      panel.series.push_back(std::move(series[group]));
    }
    figure.panels.push_back(std::move(panel));
  };
  if (!outcome.true_frequencies.empty()) {
    add(absolute, {.label = "|f_n - true|", .unit = "Hz"});
    add(relative, {.label = "relative error", .unit = "%"});
  }
  add(shape, {.label = "|phi_n(x_c)|"});
  return figure;
}

}  // namespace modcal
