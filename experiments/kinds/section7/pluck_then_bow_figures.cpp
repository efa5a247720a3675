// Figures of the route from a pluck test to the identified force.

#include "experiments/kinds/section7/pluck_then_bow.hpp"

namespace modcal {
namespace {

using report::ColorRole;
using report::SeriesStyle;

// y = value(n) over n = 1 … modes.
template <typename Value>
report::Series mode_series(std::string label, ColorRole color, SeriesStyle style, std::size_t modes,
                           Value value) {
  report::Series series{.label = std::move(label), .style = style, .color = color};
  for (std::size_t n = 1; n <= modes; ++n) series.add(static_cast<double>(n), value(n));
  return series;
}

report::Figure damping_figure(const PluckThenBowOutcome& outcome) {
  const ModalBasis& basis = outcome.stroke.basis;
  report::Series measured{.label = "pluck test", .style = SeriesStyle::kPoints};
  for (const auto& [number, mode] : outcome.pluck.found.modes) {
    measured.add(static_cast<double>(number), mode.pole.damping_ratio);
  }
  return {.id = "damping",
          .title = "1. Damping extrapolated to all modes",
          .panels = {
              {.x = {.label = "mode number n"},
               .y = {.label = "damping ratio"},
               .series = {
                   mode_series("true", ColorRole::kReference, SeriesStyle::kDashed, basis.size(),
                               [&](std::size_t n) { return basis.zeta[n - 1]; }),
                   mode_series("polynomial", ColorRole::kSecond, SeriesStyle::kLine, basis.size(),
                               [&](std::size_t n) { return outcome.damping.ratio(n); }),
                   std::move(measured)}}}};
}

// Stages by key; the route always has them.
const ModelStage& stage_of(const std::vector<ModelStage>& stages, std::string_view key) {
  return *std::find_if(stages.begin(), stages.end(),
                       [key](const ModelStage& stage) { return stage.key == key; });
}

report::Figure law_figure(const PluckThenBowOutcome& outcome) {
  const Observation& stroke = outcome.stroke;
  const ModelStage& first = stage_of(outcome.stages, "first_refined");
  const StiffStringFit& law = stage_of(outcome.stages, "law").law;
  const std::size_t plucked = first.model.basis.size(), all = stroke.basis.size();
  const auto over_harmonic = [&stroke](double frequency, std::size_t n) {
    return frequency / (static_cast<double>(n) * stroke.fundamental);
  };
  const auto by_law = [&](const StiffStringFit& fit, std::size_t modes, const char* label,
                          ColorRole color) {
    return mode_series(label, color, SeriesStyle::kLine, modes,
                       [&](std::size_t n) { return over_harmonic(fit.frequency(n), n); });
  };
  const auto of = [&](const ModalBasis& basis, std::size_t modes, const char* label,
                      ColorRole color, SeriesStyle style) {
    return mode_series(label, color, style, modes,
                       [&](std::size_t n) { return over_harmonic(basis.frequency(n - 1), n); });
  };
  const ModalBasis& from_pluck = stage_of(outcome.stages, "pluck").model.basis;
  report::Panel low{
      .title = "plucked modes",
      .x = {.label = "mode number n"},
      .y = {.label = "f_n / (n f_0), true f_0"},
      .series = {
          of(stroke.basis, plucked, "true", ColorRole::kReference, SeriesStyle::kDashed),
          of(from_pluck, from_pluck.size(), "plucked", ColorRole::kFirst, SeriesStyle::kPoints),
          of(first.model.basis, plucked, "first modes refined", ColorRole::kSecond,
             SeriesStyle::kPoints),
          by_law(first.law, plucked, "eq. 18 through these alone", ColorRole::kMuted),
          by_law(law, plucked, "eq. 18", ColorRole::kSecond)}};
  const ModalBasis& refined = outcome.all.refined.basis;
  report::Panel high{
      .title = "all modes",
      .x = {.label = "mode number n"},
      .y = {.label = "f_n / (n f_0)"},
      .series = {of(stroke.basis, all, "true", ColorRole::kReference, SeriesStyle::kDashed),
                 by_law(law, all, "eq. 18", ColorRole::kSecond),
                 of(refined, refined.size(), "refined", ColorRole::kFourth, SeriesStyle::kPoints),
                 by_law(stage_of(outcome.stages, "law_again").law, all, "eq. 18 again",
                        ColorRole::kThird)}};
  return {.id = "law",
          .title = "3. and 6. The stiff-string law (eq. 18)",
          .columns = 2,
          .panels = {std::move(low), std::move(high)}};
}

report::Figure errors_figure(const PluckThenBowOptions& options,
                             const PluckThenBowOutcome& outcome) {
  const ModalBasis& truth = outcome.stroke.basis;
  const std::vector<bool> excited =
      excited_modes({truth, outcome.stroke.contact}, options.refinement.excitation_threshold);
  const auto errors = [&](const ModelStage& stage, ColorRole color) {
    report::Series series{.label = stage.title, .style = SeriesStyle::kPoints, .color = color};
    for (std::size_t n = 0; n < truth.size(); ++n) {
      if (!excited[n]) continue;
      series.add(static_cast<double>(n + 1),
                 std::abs(stage.model.basis.omega[n] / truth.omega[n] - 1.0));
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
          .title = "Errors of the modal frequencies after the steps",
          .caption = "Modes that the contact excites.",
          .panels = {std::move(panel)}};
}

report::Figure contact_figure(const PluckThenBowOptions& options,
                              const PluckThenBowOutcome& outcome) {
  report::Series curve{.y = outcome.curve.values, .style = SeriesStyle::kLineWithPoints};
  for (const double x : outcome.curve.positions) curve.x.push_back(1e3 * x);
  report::Panel panel{
      .x = {.label = "contact point", .unit = "mm"},
      .y = {.label = fmt::format("objective {}", options.contact.objective.selected())},
      .series = {std::move(curve)},
      .markers = {
          {.value = 1e3 * outcome.stroke.contact, .label = "true"},
          {.value = 1e3 * outcome.stages.back().model.contact,
           .label = "found",
           .color = ColorRole::kFirst},
          {.value = 1e3 * options.contact.start, .label = "start", .color = ColorRole::kMuted}}};
  return {.id = "contact", .title = "7. The contact point", .panels = {std::move(panel)}};
}

report::Figure candidates_figure(std::string id, std::string title, std::int64_t modes,
                                 const CalibrationOutcome& outcome) {
  FigureOptions options;
  options.id = std::move(id);
  options.title = std::move(title);
  options.modes = modes;
  return objective_figure(options, outcome);
}

}  // namespace

std::vector<report::Figure> pluck_then_bow_figures(const PluckThenBowOptions& options,
                                                   const PluckThenBowOutcome& outcome) {
  std::vector<report::Figure> figures;
  report::Figure diagram = stabilization_figure(outcome.pluck);
  diagram.title = "1. Stabilization diagram of the pluck test";
  figures.push_back(std::move(diagram));
  figures.push_back(damping_figure(outcome));
  // Only the systematic search keeps its candidates.
  if (!outcome.first.result.search.scans.empty()) {
    figures.push_back(candidates_figure("first_objectives", "2. The first modes refined",
                                        options.refinement.first_modes, outcome.first));
    figures.push_back(
        candidates_figure("objectives", "5. All modes refined (paper, fig. 20)", 12, outcome.all));
  }
  figures.push_back(law_figure(outcome));
  figures.push_back(errors_figure(options, outcome));
  figures.push_back(contact_figure(options, outcome));
  return figures;
}

}  // namespace modcal
