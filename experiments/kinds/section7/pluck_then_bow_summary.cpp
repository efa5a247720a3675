// What the route from a pluck test to the identified force says in words.
#include <cmath>

#include "experiments/kinds/section7/pluck_then_bow.hpp"

namespace modcal {
namespace {

std::string line_of(const PluckThenBowOptions& options, const PluckThenBowOutcome& outcome,
                    const ModelStage& stage) {
  const FrequencyErrors errors = errors_of(options, outcome, stage);
  return fmt::format(
      "{:<44} f0 {:.4f} Hz, B {:.4g}, x_c {:.3f} mm, frequencies off by {:.2g} "
      "(largest {:.2g})\n",
      stage.title, stage.law.fundamental, stage.law.inharmonicity, 1e3 * stage.model.contact,
      errors.median, errors.largest);
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
  result.summary += "warning: " + text + "\n";
  result.blocks.emplace_back(report::Text{text, report::Text::Kind::kWarning});
}

std::string sides_line(const std::vector<SideIdentification>& sides) {
  std::string text;
  for (const SideIdentification& side : sides) {
    for (const WindowScore& score : side.scores) {
      text += fmt::format(" {} {:.3f}", side.estimate.side, score.correlation);
    }
  }
  return text + "\n";
}

}  // namespace

StudyResult pluck_then_bow_study(const PluckThenBowOptions& options, const StudyContext& context) {
  const PluckThenBowOutcome outcome = pluck_then_bow(options, context);
  StudyResult result;
  result.summary =
      fmt::format("{} modes identified in the pluck test\n", outcome.pluck.found.modes.size());
  for (const ModelStage& stage : outcome.stages) {
    result.summary += line_of(options, outcome, stage);
  }
  result.summary += "correlation with the true force, by side:" + sides_line(outcome.sides);
  for (const ModelStage& stage : outcome.bound_stages) {
    result.summary += line_of(options, outcome, stage);
  }
  if (outcome.has_bound) {
    result.summary +=
        fmt::format("reduced chi2 {:.4f}: {}\n", outcome.bound.chi2,
                    outcome.bound.fits ? "the data do not contradict the fit" : "THE FIT IS WRONG");
    result.summary += prior_lines(outcome.bound.law.priors, "law");
    if (outcome.bound.frequencies_free) {
      result.summary += prior_lines(outcome.bound.priors, "every frequency");
    }
    result.summary += "correlation with the true force, by side:" + sides_line(outcome.bound_sides);
  }
  add_distance_warning(options, outcome, result);
  for (report::Block& block : pluck_then_bow_blocks(options, outcome, context.command)) {
    result.blocks.push_back(std::move(block));
  }
  add_identification_figures(options.figures, outcome.stroke, outcome.sides, result);
  result.files.emplace_back("pluck_then_bow.json", pluck_then_bow_json(options, outcome));
  return result;
}

}  // namespace modcal
