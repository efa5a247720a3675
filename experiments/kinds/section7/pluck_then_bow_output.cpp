// Tables and JSON of the route from a pluck test to the identified force.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "experiments/kinds/section7/pluck_then_bow.hpp"
#include "experiments/report/result_json.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

using Json = nlohmann::ordered_json;
using report::Cell;

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

report::Table sides_table(std::string id, std::string title,
                          const std::vector<SideIdentification>& sides,
                          const std::string& command) {
  report::Table table = identification_table(sides);
  table.command = command;
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
  for (report::Figure& figure : pluck_then_bow_figures(options, outcome, command)) {
    blocks.emplace_back(std::move(figure));
  }
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
                   {"pluck", report::json_of(outcome.pluck)},
                   {"pluck_likelihood", report::json_of(outcome.likelihood)},
                   {"damping_polynomial", outcome.damping.coefficients},
                   {"steps", std::move(stages)},
                   {"identification", sides_json(outcome.sides)}};
  if (outcome.has_bound) {
    document["bound_steps"] = std::move(bound);
    document["bound_chi2"] = number_or_null(outcome.bound.chi2);
    document["bound_right"] = outcome.bound.right;
    document["bound_fits"] = outcome.bound.fits;
    document["bound_priors_contradicted"] = outcome.bound.priors.contradicted();
    document["bound_identification"] = sides_json(outcome.bound_sides);
  }
  return document.dump(1) + "\n";
}

}  // namespace modcal
