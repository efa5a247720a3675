// Figures of the route from a pluck test to the identified force.
#include <algorithm>
#include <cmath>

#include "experiments/kinds/section7/pluck_then_bow.hpp"

namespace modcal {
namespace {

using report::ColorRole;
using report::SeriesStyle;

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

}  // namespace

std::vector<report::Figure> pluck_then_bow_figures(const PluckThenBowOptions& options,
                                                   const PluckThenBowOutcome& outcome,
                                                   const std::string& command) {
  std::vector<report::Figure> figures;
  report::Figure diagram = stabilization_figure(outcome.pluck);
  diagram.title = "1. Stabilization diagram of the pluck test";
  figures.push_back(std::move(diagram));
  figures.push_back(damping_figure(outcome, command));
  // Only the systematic search keeps its candidates.
  if (!outcome.first.result.search.scans.empty()) {
    figures.push_back(candidates_figure("first_objectives", "2. The first modes refined",
                                        options.refinement.first_modes, outcome.first, command));
    figures.push_back(candidates_figure("objectives", "5. All modes refined (paper, fig. 20)", 12,
                                        outcome.all, command));
  }
  figures.push_back(law_figure(outcome, command));
  figures.push_back(errors_figure(options, outcome, command));
  figures.push_back(contact_figure(options, outcome, command));
  return figures;
}

}  // namespace modcal
