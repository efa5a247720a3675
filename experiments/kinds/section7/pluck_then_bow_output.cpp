// What the route from a pluck test to the identified force found: tables, JSON, words.

#include "experiments/kinds/section7/pluck_then_bow.hpp"
#include "experiments/report/result.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

/// The mode of the same number; null where that fit has none.
const DecayMode* find_mode(const PluckIdentification& found, std::size_t number) {
  const auto place = std::find_if(found.modes.begin(), found.modes.end(),
                                  [number](const auto& mode) { return mode.number == number; });
  return place == found.modes.end() ? nullptr : &place->mode;
}

/// Left: the poles that the route goes on with.
void visit_plucked_mode(const PluckThenBowOutcome& outcome, const PluckedMode& plucked,
                        ResultVisitor& row) {
  const auto& [number, mode] = plucked;
  const DecayMode* const fitted = find_mode(outcome.likelihood.found, number);
  const DecayMode other = fitted != nullptr ? *fitted : DecayMode{};
  const auto likelihood = [fitted](double value) {
    return fitted != nullptr ? known(value) : std::nullopt;
  };
  const ModalBasis& truth = outcome.stroke.basis;
  const bool is_known = number <= truth.size();
  const auto of_truth = [is_known](double value) {
    return is_known ? std::optional(value) : std::nullopt;
  };
  const std::size_t n = is_known ? number - 1 : 0;
  row({.key = "n", .name = "mode"}, number);
  row({.key = "f_hz", .name = "frequency", .unit = "Hz", .format = "{:.7g}"}, mode.pole.frequency);
  row({.key = "zeta", .name = "damping ratio"}, mode.pole.damping_ratio);
  row({.key = "f_likelihood_hz", .name = "likelihood", .unit = "Hz", .format = "{:.7g}"},
      likelihood(other.pole.frequency));
  row({.key = "f_sd_hz", .name = "its deviation", .unit = "Hz", .format = "{:.2g}"},
      likelihood(other.deviation.frequency));
  row({.key = "zeta_likelihood", .name = "damping ratio, likelihood"},
      likelihood(other.pole.damping_ratio));
  row({.key = "zeta_sd", .name = "its deviation", .format = "{:.2g}"},
      likelihood(other.deviation.damping_ratio));
  row({.key = "f_true_hz", .name = "true", .unit = "Hz", .format = "{:.7g}"},
      of_truth(truth.frequency(n)));
  row({.key = "zeta_true", .name = "true damping ratio"}, of_truth(truth.zeta[n]));
}

void visit_side(ResultVisitor& row, const SideIdentification& side) {
  row({.key = "side"}, side.estimate.side);
  row({.key = "parameter"}, side.estimate.result.choice.parameter());
  row.rows({.key = "scores"}, side.scores, [](ResultVisitor& score, const WindowScore& window) {
    score({.key = "start_s"}, window.start);
    score({.key = "correlation"}, window.correlation);
    score({.key = "relative_rms_error"}, window.relative_rms_error);
  });
}

report::Table sides_table(std::string id, std::string title,
                          const std::vector<SideIdentification>& sides) {
  report::Table table = identification_table(sides);
  table.id = std::move(id);
  table.title = std::move(title);
  if (sides.size() == 2) {
    table.caption =
        fmt::format("Correlation of the two identified forces over the record: {:.4f}.",
                    correlation(sides[0].estimate.result.force, sides[1].estimate.result.force));
  }
  return table;
}

std::string line_of(const ModelStage& stage) {
  return fmt::format(
      "{:<44} f0 {:.4f} Hz, B {}, x_c {:.3f} mm, frequencies off by {:.2g} "
      "(largest {:.2g})\n",
      stage.title, stage.law.fundamental, inharmonicity_text(stage.law.inharmonicity),
      1e3 * stage.model.contact, stage.median_error, stage.largest_error);
}

/// Rms distance of the first refined frequencies from those of the pluck test, in its standard
/// deviations; NaN where these are not known.
double distance_from_pluck(const PluckThenBowOutcome& outcome, std::size_t first_modes) {
  double sum = 0.0, count = 0.0;
  for (const auto& [number, mode] : outcome.likelihood.found.modes) {
    if (number > first_modes) continue;
    const double refined = outcome.first.refined.basis.frequency(number - 1);
    sum += std::pow((refined - mode.pole.frequency) / mode.deviation.frequency, 2);
    count += 1.0;
  }
  return std::sqrt(sum / count);
}

void add_distance_warning(const PluckThenBowOptions& options, const PluckThenBowOutcome& outcome,
                          StudyResult& result) {
  const auto modes = static_cast<std::size_t>(options.refinement.first_modes);
  const double distance = distance_from_pluck(outcome, modes);
  constexpr double kContradicted = 5.0;
  if (!(distance > kContradicted)) return;
  const std::string text = fmt::format(
      "the first {} frequencies refined by {} lie {:.3g} standard deviations (rms) off the pluck "
      "test's: one string cannot have both; believe the pluck test",
      modes, options.refinement.objective.selected(), distance);
  result.warn(text);
}

// "correlation with the true force 0.801 from R_1, 0.818 from R_2".
std::string sides_text(const std::vector<SideIdentification>& sides) {
  std::string text;
  for (const SideIdentification& side : sides) {
    for (const WindowScore& score : side.scores) {
      text += fmt::format("{}{:.3f} from R_{}",
                          text.empty() ? "correlation with the true force " : ", ",
                          score.correlation, side.estimate.side);
    }
  }
  return text;
}

std::string answer_of(const PluckThenBowOutcome& outcome) {
  const ModelStage& last =
      outcome.bound_stages.empty() ? outcome.stages.back() : outcome.bound_stages.back();
  return fmt::format(
      "f0 = {:.6g} Hz, B = {}, x_c = {:.5g} mm; median error of a frequency {:.2g}; {}",
      last.law.fundamental, inharmonicity_text(last.law.inharmonicity), 1e3 * last.model.contact,
      last.median_error, sides_text(outcome.has_bound ? outcome.bound_sides : outcome.sides));
}

}  // namespace

void ModelStage::visit(ResultVisitor& visitor) const {
  constexpr auto kInJson = ResultVisitor::kInJson, kInTables = ResultVisitor::kInTables;
  visitor({.key = "step", .shown = kInJson}, key);
  visitor({.key = "title", .shown = kInJson}, title);
  visitor({.key = "step", .shown = kInTables}, title);
  visitor({.key = "modes", .shown = kInTables}, model.basis.size());
  visitor({}, law);
  visitor({.key = "x_c_m", .shown = kInJson}, model.contact);
  visitor({.key = "x_c_sd_m", .shown = kInJson}, contact_deviation);
  visitor({.key = "x_c_mm", .name = "x_c", .unit = "mm", .format = "{:.4f}", .shown = kInTables},
          1e3 * model.contact);
  visitor({.key = "x_c_sd_mm",
           .name = " its deviation",
           .unit = "mm",
           .format = "{:.2g}",
           .shown = kInTables},
          known(1e3 * contact_deviation));
  visitor(
      {.key = "median_relative_error_excited", .name = "median error of f_n", .format = "{:.2g}"},
      known(median_error));
  visitor({.key = "largest_relative_error_excited", .name = "largest", .format = "{:.2g}"},
          known(largest_error));
  visitor({.key = "evaluations"}, evaluations);
  visitor({.key = "f_hz"}, frequencies_of(model.basis));
  visitor({.key = "relative_sd"}, deviation);
}

void PluckThenBowOutcome::visit(ResultVisitor& visitor) const {
  std::vector<ModelStage> all_stages = stages;
  all_stages.insert(all_stages.end(), bound_stages.begin(), bound_stages.end());
  all_stages.push_back(truth);
  visitor({.table = "stages",
           .name = "Model after every step",
           .meaning = "Errors: over the modes that the contact excites. Deviations of fitted laws: "
                      "from the scatter about them.",
           .shown = ResultVisitor::kInTables},
          all_stages);
  visitor.rows({.table = "pluck",
                .name = "1. Modes of the pluck test",
                .meaning = "Left: the poles that the route goes on with. Right: maximum likelihood "
                           "with its standard deviations, the prior of the calibration to the "
                           "bound.",
                .shown = ResultVisitor::kInTables},
               pluck.found.modes, [this](ResultVisitor& row, const PluckedMode& mode) {
                 visit_plucked_mode(*this, mode, row);
               });
  visitor.group({.key = "truth"}, [this](ResultVisitor& members) {
    members({.key = "f0_hz"}, truth.law.fundamental);
    members({.key = "B"}, truth.law.inharmonicity);
    members({.key = "x_c_m"}, truth.model.contact);
  });
  visitor({.key = "pluck", .shown = ResultVisitor::kInJson}, pluck);
  visitor({.key = "pluck_likelihood", .shown = ResultVisitor::kInJson}, likelihood);
  visitor({.key = "damping_polynomial"}, damping.coefficients);
  visitor({.key = "steps"}, stages);
  visitor.rows({.key = "identification"}, sides, visit_side);
  if (!has_bound) return;
  visitor({.key = "bound_steps"}, bound_stages);
  visitor({.key = "bound_chi2"}, bound.chi2);
  visitor({.key = "bound_right"}, bound.right);
  visitor({.key = "bound_fits"}, bound.fits);
  visitor({.key = "bound_priors_contradicted"}, bound.priors.contradicted());
  visitor.rows({.key = "bound_identification"}, bound_sides, visit_side);
}

StudyResult PluckThenBowOptions::run(const StudyContext& context) const {
  const PluckThenBowOutcome outcome = pluck_then_bow(*this, context);
  StudyResult result;
  result.summary =
      fmt::format("{} modes identified in the pluck test\n", outcome.pluck.found.modes.size());
  for (const ModelStage& stage : outcome.stages) {
    result.summary += line_of(stage);
  }
  result.summary += sides_text(outcome.sides) + "\n";
  for (const ModelStage& stage : outcome.bound_stages) {
    result.summary += line_of(stage);
  }
  if (outcome.has_bound) {
    result.summary +=
        fmt::format("reduced chi2 {:.4f}: {}\n", outcome.bound.chi2,
                    outcome.bound.fits ? "the data do not contradict the fit" : "THE FIT IS WRONG");
    result.summary += prior_lines(outcome.bound.law.priors, "law");
    if (outcome.bound.frequencies_free) {
      result.summary += prior_lines(outcome.bound.priors, "every frequency");
    }
    result.summary += sides_text(outcome.bound_sides) + "\n";
  }
  result.answer = answer_of(outcome);
  add_distance_warning(*this, outcome, result);
  std::vector<report::Figure> figures_of_steps = pluck_then_bow_figures(*this, outcome);
  const auto errors = std::ranges::find(figures_of_steps, "frequency_errors", &report::Figure::id);
  result.blocks.emplace_back(std::move(*errors));
  figures_of_steps.erase(errors);
  report::Table from_ends =
      sides_table("identification", "8. Identification from either end", outcome.sides);
  result.add({outcome.has_bound
                  ? sides_table("identification_bound",
                                "Identification with the model at the bound", outcome.bound_sides)
                  : from_ends});
  result.end_first_screen();
  if (outcome.has_bound) result.add({std::move(from_ends)});
  result.add(report::tables_of(outcome));
  for (report::Figure& figure : figures_of_steps) result.blocks.emplace_back(std::move(figure));
  add_identification_figures(figures, outcome.stroke, outcome.sides, result);
  result.files.emplace_back("pluck_then_bow.json", report::json_file(report::json_of(outcome)));
  return result;
}

}  // namespace modcal
