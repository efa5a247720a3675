// Tables, figures and JSON of the route from a pluck test to the identified force.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "experiments/kinds/pluck_then_bow.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

using Json = nlohmann::ordered_json;
using report::Cell;
using report::ColorRole;
using report::SeriesStyle;

Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }
Cell number_or_none(double value) { return std::isfinite(value) ? Cell(value) : Cell(); }

/// The mode of the same number; null where that fit has none.
const DecayMode* find_mode(const PluckIdentification& found, std::size_t number) {
  const auto place = std::find_if(found.modes.begin(), found.modes.end(),
                                  [number](const auto& mode) { return mode.number == number; });
  return place == found.modes.end() ? nullptr : &place->mode;
}

report::Table pluck_table(const PluckThenBowOutcome& outcome, const std::string& command) {
  report::Table table{
      .id = "pluck",
      .title = "1. Modes of the pluck test",
      .caption =
          "Left: the poles that the route goes on with. Right: maximum likelihood with its "
          "standard deviations, the prior of the calibration to the bound.",
      .columns =
          {{.key = "n", .name = "mode"},
           {.key = "f_hz", .name = "frequency", .unit = "Hz", .format = "{:.7g}"},
           {.key = "zeta", .name = "damping ratio"},
           {.key = "f_likelihood_hz", .name = "likelihood", .unit = "Hz", .format = "{:.7g}"},
           {.key = "f_sd_hz", .name = "its deviation", .unit = "Hz", .format = "{:.2g}"},
           {.key = "zeta_likelihood", .name = "damping ratio, likelihood"},
           {.key = "zeta_sd", .name = "its deviation", .format = "{:.2g}"},
           {.key = "f_true_hz", .name = "true", .unit = "Hz", .format = "{:.7g}"},
           {.key = "zeta_true", .name = "true damping ratio"}},
      .command = command};
  const ModalBasis& truth = outcome.stroke.basis;
  for (const auto& [number, mode] : outcome.pluck.found.modes) {
    std::vector<Cell> row = {number, mode.pole.frequency, mode.pole.damping_ratio};
    if (const DecayMode* fitted = find_mode(outcome.likelihood.found, number)) {
      row.insert(row.end(),
                 {fitted->pole.frequency, number_or_none(fitted->deviation.frequency),
                  fitted->pole.damping_ratio, number_or_none(fitted->deviation.damping_ratio)});
    } else {
      row.resize(row.size() + 4);
    }
    const bool known = number <= truth.size();
    row.push_back(known ? Cell(truth.frequency(number - 1)) : Cell());
    row.push_back(known ? Cell(truth.zeta[number - 1]) : Cell());
    table.rows.push_back(std::move(row));
  }
  return table;
}

report::Figure damping_figure(const PluckThenBowOutcome& outcome, const std::string& command) {
  report::Series measured{.label = "pluck test", .style = SeriesStyle::kPoints};
  report::Series fitted{.label = "polynomial", .color = ColorRole::kSecond};
  report::Series truth{
      .label = "true", .style = SeriesStyle::kDotted, .color = ColorRole::kReference};
  for (const auto& [number, mode] : outcome.pluck.found.modes) {
    measured.x.push_back(static_cast<double>(number));
    measured.y.push_back(mode.pole.damping_ratio);
  }
  for (std::size_t n = 1; n <= outcome.stroke.basis.size(); ++n) {
    fitted.x.push_back(static_cast<double>(n));
    fitted.y.push_back(outcome.damping.ratio(n));
    truth.x.push_back(static_cast<double>(n));
    truth.y.push_back(outcome.stroke.basis.zeta[n - 1]);
  }
  return {.id = "damping",
          .title = "1. Damping extrapolated to all modes",
          .panels = {{.x = {.label = "mode number n"},
                      .y = {.label = "damping ratio"},
                      .series = {std::move(truth), std::move(fitted), std::move(measured)}}},
          .command = command};
}

report::Series law_series(const StiffStringFit& law, std::size_t modes, double reference,
                          std::string label, ColorRole color) {
  report::Series series{.label = std::move(label), .color = color};
  for (std::size_t n = 1; n <= modes; ++n) {
    series.x.push_back(static_cast<double>(n));
    series.y.push_back(law.frequency(n) / (static_cast<double>(n) * reference));
  }
  return series;
}

report::Series mode_series(const ModalBasis& basis, double reference, std::string label,
                           ColorRole color, SeriesStyle style) {
  report::Series series{.label = std::move(label), .style = style, .color = color};
  for (std::size_t n = 1; n <= basis.size(); ++n) {
    series.x.push_back(static_cast<double>(n));
    series.y.push_back(basis.frequency(n - 1) / (static_cast<double>(n) * reference));
  }
  return series;
}

// Stages by key; the route always has them.
const ModelStage& stage_of(const std::vector<ModelStage>& stages, std::string_view key) {
  return *std::find_if(stages.begin(), stages.end(),
                       [key](const ModelStage& stage) { return stage.key == key; });
}

report::Figure law_figure(const PluckThenBowOutcome& outcome, const std::string& command) {
  const Observation& stroke = outcome.stroke;
  const double reference = stroke.fundamental;
  const ModelStage& first = stage_of(outcome.stages, "first_refined");
  const ModelStage& law = stage_of(outcome.stages, "law");
  const ModelStage& again = stage_of(outcome.stages, "law_again");
  const std::size_t plucked = first.model.basis.size();
  report::Panel low{.title = "plucked modes",
                    .x = {.label = "mode number n"},
                    .y = {.label = "f_n / (n f_0), true f_0"}};
  low.series = {
      mode_series(stroke.basis, reference, "true", ColorRole::kReference, SeriesStyle::kDotted),
      mode_series(stage_of(outcome.stages, "pluck").model.basis, reference, "plucked",
                  ColorRole::kFirst, SeriesStyle::kPoints),
      mode_series(first.model.basis, reference, "first modes refined", ColorRole::kSecond,
                  SeriesStyle::kPoints),
      law_series(first.law, plucked, reference, "eq. 18 through these alone", ColorRole::kMuted),
      law_series(law.law, plucked, reference, "eq. 18", ColorRole::kSecond)};
  low.series.front().x.resize(plucked);
  low.series.front().y.resize(plucked);
  const std::size_t all = stroke.basis.size();
  report::Panel high{
      .title = "all modes", .x = {.label = "mode number n"}, .y = {.label = "f_n / (n f_0)"}};
  high.series = {
      mode_series(stroke.basis, reference, "true", ColorRole::kReference, SeriesStyle::kDotted),
      law_series(law.law, all, reference, "eq. 18", ColorRole::kSecond),
      mode_series(outcome.all.refined.basis, reference, "refined", ColorRole::kFirst,
                  SeriesStyle::kPoints),
      law_series(again.law, all, reference, "eq. 18 again", ColorRole::kThird)};
  return {.id = "law",
          .title = "3. and 6. The stiff-string law (eq. 18)",
          .columns = 2,
          .panels = {std::move(low), std::move(high)},
          .command = command};
}

report::Figure errors_figure(const PluckThenBowOptions& options, const PluckThenBowOutcome& outcome,
                             const std::string& command) {
  const ModalBasis& truth = outcome.stroke.basis;
  const std::vector<bool> excited =
      excited_modes({truth, outcome.stroke.contact}, options.refinement.excitation_threshold);
  const auto errors = [&](const ModelStage& stage, ColorRole color) {
    report::Series series{.label = stage.title, .style = SeriesStyle::kPoints, .color = color};
    for (std::size_t n = 0; n < truth.size(); ++n) {
      if (!excited[n]) continue;
      series.x.push_back(static_cast<double>(n + 1));
      series.y.push_back(std::abs(stage.model.basis.omega[n] / truth.omega[n] - 1.0));
    }
    return series;
  };
  report::Panel panel{.x = {.label = "mode number n"},
                      .y = {.label = "relative error of f_n", .logarithmic = true}};
  panel.series = {errors(stage_of(outcome.stages, "law"), ColorRole::kMuted),
                  errors(stage_of(outcome.stages, "refined"), ColorRole::kFirst)};
  if (outcome.has_bound) {
    panel.series.push_back(errors(outcome.bound_stages.front(), ColorRole::kFourth));
    panel.series.push_back(errors(outcome.bound_stages.back(), ColorRole::kThird));
  }
  return {.id = "frequency_errors",
          .title = "5. Errors of the modal frequencies",
          .caption = "Modes that the contact excites.",
          .panels = {std::move(panel)},
          .command = command};
}

report::Figure contact_figure(const PluckThenBowOptions& options,
                              const PluckThenBowOutcome& outcome, const std::string& command) {
  report::Series curve{.label = std::string(options.contact.objective.selected()),
                       .y = outcome.curve.values,
                       .style = SeriesStyle::kLineWithPoints};
  for (const double x : outcome.curve.positions) curve.x.push_back(1e3 * x);
  report::Panel panel{
      .x = {.label = "contact point", .unit = "mm"},
      .y = {.label = "objective"},
      .series = {std::move(curve)},
      .markers = {
          {.value = 1e3 * outcome.stroke.contact, .label = "true"},
          {.value = 1e3 * outcome.stages.back().model.contact,
           .label = "found",
           .color = ColorRole::kFirst},
          {.value = 1e3 * options.contact.start, .label = "start", .color = ColorRole::kMuted}}};
  return {.id = "contact",
          .title = "7. The contact point",
          .panels = {std::move(panel)},
          .command = command};
}

std::vector<Cell> stage_row(const PluckThenBowOptions& options, const PluckThenBowOutcome& outcome,
                            const ModelStage& stage) {
  const FrequencyErrors errors = errors_of(options, outcome, stage);
  const StiffStringFit& law = stage.law;
  return {stage.title,
          stage.model.basis.size(),
          law.fundamental,
          number_or_none(law.fundamental_deviation),
          law.inharmonicity,
          number_or_none(law.inharmonicity_deviation),
          1e3 * stage.model.contact,
          number_or_none(1e3 * stage.contact_deviation),
          errors.median,
          errors.largest,
          stage.evaluations};
}

report::Table stages_table(const PluckThenBowOptions& options, const PluckThenBowOutcome& outcome,
                           const std::string& command) {
  report::Table table{
      .id = "stages",
      .title = "Model after every step",
      .caption =
          "Errors: over the modes that the contact excites. Deviations of fitted laws: from "
          "the scatter about them.",
      .columns = {{.key = "step"},
                  {.key = "modes"},
                  {.key = "f0_hz", .name = "f_0", .unit = "Hz", .format = "{:.4f}"},
                  {.key = "f0_sd_hz", .name = "its deviation", .unit = "Hz", .format = "{:.2g}"},
                  {.key = "B", .format = "{:.4e}"},
                  {.key = "B_sd", .name = "its deviation ", .format = "{:.2g}"},
                  {.key = "x_c_mm", .name = "x_c", .unit = "mm", .format = "{:.4f}"},
                  {.key = "x_c_sd_mm", .name = " its deviation", .unit = "mm", .format = "{:.2g}"},
                  {.key = "median_error", .name = "median error of f_n", .format = "{:.2g}"},
                  {.key = "largest_error", .name = "largest", .format = "{:.2g}"},
                  {.key = "evaluations"}},
      .command = command};
  for (const ModelStage& stage : outcome.stages) {
    table.rows.push_back(stage_row(options, outcome, stage));
  }
  for (const ModelStage& stage : outcome.bound_stages) {
    table.rows.push_back(stage_row(options, outcome, stage));
  }
  const Observation& stroke = outcome.stroke;
  const StringModel& string = options.truth.scene.string;
  table.rows.push_back({"truth", stroke.basis.size(), string.fundamental, Cell(),
                        string.inharmonicity, Cell(), 1e3 * stroke.contact, Cell(), Cell(), Cell(),
                        Cell()});
  return table;
}

report::Figure candidates_figure(std::string id, std::string title, std::int64_t modes,
                                 const CalibrationOutcome& outcome, const std::string& command) {
  FigureOptions options;
  options.id = std::move(id);
  options.title = std::move(title);
  options.modes = modes;
  report::Figure figure = objective_figure(options, outcome);
  figure.command = command;
  return figure;
}

report::Table sides_table(std::string id, std::string title,
                          const std::vector<SideIdentification>& sides,
                          const std::string& command) {
  report::Table table = identification_table(sides, command);
  table.id = std::move(id);
  table.title = std::move(title);
  if (sides.size() == 2) {
    table.caption =
        fmt::format("Correlation of the two identified forces over the record: {:.4f}.",
                    correlation(sides[0].estimate.result.force, sides[1].estimate.result.force));
  }
  return table;
}

Json stage_json(const PluckThenBowOptions& options, const PluckThenBowOutcome& outcome,
                const ModelStage& stage) {
  const FrequencyErrors errors = errors_of(options, outcome, stage);
  Json frequencies = Json::array(), deviations = Json::array();
  for (std::size_t n = 0; n < stage.model.basis.size(); ++n) {
    frequencies.push_back(stage.model.basis.frequency(n));
  }
  for (const double deviation : stage.deviation) deviations.push_back(number_or_null(deviation));
  return {{"step", stage.key},
          {"title", stage.title},
          {"f0_hz", stage.law.fundamental},
          {"f0_sd_hz", number_or_null(stage.law.fundamental_deviation)},
          {"B", stage.law.inharmonicity},
          {"B_sd", number_or_null(stage.law.inharmonicity_deviation)},
          {"x_c_m", stage.model.contact},
          {"x_c_sd_m", number_or_null(stage.contact_deviation)},
          {"median_relative_error_excited", errors.median},
          {"largest_relative_error_excited", errors.largest},
          {"evaluations", stage.evaluations},
          {"f_hz", std::move(frequencies)},
          {"relative_sd", std::move(deviations)}};
}

Json sides_json(const std::vector<SideIdentification>& sides) {
  Json list = Json::array();
  for (const SideIdentification& side : sides) {
    Json scores = Json::array();
    for (const WindowScore& score : side.scores) {
      scores.push_back({{"start_s", score.start},
                        {"correlation", number_or_null(score.correlation)},
                        {"relative_rms_error", number_or_null(score.relative_rms_error)}});
    }
    list.push_back({{"side", side.estimate.side},
                    {"parameter", number_or_null(side.estimate.result.choice.parameter())},
                    {"scores", std::move(scores)}});
  }
  return list;
}

}  // namespace

std::vector<report::Block> pluck_then_bow_blocks(const PluckThenBowOptions& options,
                                                 const PluckThenBowOutcome& outcome,
                                                 const std::string& command) {
  std::vector<report::Block> blocks;
  blocks.emplace_back(stages_table(options, outcome, command));
  blocks.emplace_back(pluck_table(outcome, command));
  report::Figure diagram = stabilization_figure(outcome.pluck, command);
  diagram.title = "1. Stabilization diagram of the pluck test";
  blocks.emplace_back(std::move(diagram));
  blocks.emplace_back(damping_figure(outcome, command));
  // Only the systematic search keeps its candidates.
  if (!outcome.first.result.search.scans.empty()) {
    blocks.emplace_back(candidates_figure("first_objectives", "2. The first modes refined",
                                          options.refinement.first_modes, outcome.first, command));
    blocks.emplace_back(candidates_figure("objectives", "5. All modes refined (paper, fig. 20)", 12,
                                          outcome.all, command));
  }
  blocks.emplace_back(law_figure(outcome, command));
  blocks.emplace_back(errors_figure(options, outcome, command));
  blocks.emplace_back(contact_figure(options, outcome, command));
  blocks.emplace_back(
      sides_table("identification", "8. Identification from either end", outcome.sides, command));
  if (outcome.has_bound) {
    blocks.emplace_back(sides_table("identification_bound",
                                    "Identification with the model at the bound",
                                    outcome.bound_sides, command));
  }
  return blocks;
}

std::string pluck_then_bow_json(const PluckThenBowOptions& options,
                                const PluckThenBowOutcome& outcome) {
  Json stages = Json::array(), bound = Json::array();
  for (const ModelStage& stage : outcome.stages) {
    stages.push_back(stage_json(options, outcome, stage));
  }
  for (const ModelStage& stage : outcome.bound_stages) {
    bound.push_back(stage_json(options, outcome, stage));
  }
  const StringModel& string = options.truth.scene.string;
  Json document = {{"truth",
                    {{"f0_hz", string.fundamental},
                     {"B", string.inharmonicity},
                     {"x_c_m", outcome.stroke.contact}}},
                   {"pluck", Json::parse(identification_json(outcome.pluck))},
                   {"pluck_likelihood", Json::parse(identification_json(outcome.likelihood))},
                   {"damping_polynomial", outcome.damping.coefficients},
                   {"steps", std::move(stages)},
                   {"identification", sides_json(outcome.sides)}};
  if (outcome.has_bound) {
    document["bound_steps"] = std::move(bound);
    document["bound_chi2"] = number_or_null(outcome.bound.chi2);
    document["bound_right"] = outcome.bound.right;
    document["bound_identification"] = sides_json(outcome.bound_sides);
  }
  return document.dump(1) + "\n";
}

}  // namespace modcal
