#include "experiments/kinds/structure/modes_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "experiments/kinds/structure/structure_files.hpp"

namespace modcal {

using report::Series;

namespace {

// Whether a pair of poles has moved by less than 1 % in frequency and 20 % in damping from one of
// the others: what a mode does when another is added.
bool stays(const ModalPole& pole, std::span<const ModalPole> others) {
  return std::ranges::any_of(others, [&](const ModalPole& other) {
    return std::abs(other.omega - pole.omega) < 0.01 * pole.omega &&
           std::abs(other.zeta - pole.zeta) < 0.2 * pole.zeta;
  });
}

}  // namespace

report::Figure stabilization_figure(const StrikeFit& fit) {
  Series moving{.label = "moves when a mode is added",
                .style = report::SeriesStyle::kPoints,
                .color = report::ColorRole::kMuted};
  Series stable{.label = "stays", .style = report::SeriesStyle::kPoints};
  std::span<const ModalPole> before;
  for (const ModeCount& step : fit.steps) {
    for (const ModalPole& pole : step.poles) {
      (stays(pole, before) ? stable : moving)
          .add(pole.omega / (2.0 * std::numbers::pi), static_cast<double>(step.modes));
    }
    before = step.poles;
  }
  return {.id = "stabilization",
          .title = "Stabilization diagram",
          .caption =
              "Frequencies over the number of modes. A mode of the structure stays, within "
              "1 % in frequency and 20 % in damping, when another one is added.",
          .panels = {{.x = {.label = "frequency", .unit = "Hz"},
                      .y = {.label = "number of modes"},
                      .series = {std::move(moving), std::move(stable)}}}};
}

report::Figure criterion_figure(const StrikeFit& fit) {
  Series criterion{.label = "BIC", .style = report::SeriesStyle::kLineWithPoints};
  for (const ModeCount& step : fit.steps) {
    criterion.add(static_cast<double>(step.modes), step.criterion);
  }
  const auto chosen = static_cast<double>(fit.table.model.poles.size());
  return {.id = "criterion",
          .title = "How many modes the record tells",
          .caption = "Bayesian information criterion over the number of modes; the least is taken.",
          .panels = {{.x = {.label = "number of modes"},
                      .y = {.label = "BIC"},
                      .series = {std::move(criterion)},
                      .markers = {{.value = chosen, .label = "taken"}}}}};
}

report::Figure responses_figure(const StrikeFit& fit) {
  const StructureTable& table = fit.table;
  report::Figure figure{
      .id = "responses",
      .title = fit.strikes.size() > 1 ? "Responses to the first strike and the model's"
                                      : "Responses to the strike and the model's",
      .caption =
          "Magnitude of response over force on the contour of the fit, and of what the model "
          "leaves of it.",
      .columns = table.names.size() > 1 ? 2u : 1u};
  for (std::size_t k = 0; k < table.names.size(); ++k) {
    Series measured{.label = "measured", .color = report::ColorRole::kReference};
    Series modeled{.label = "model"};
    Series left{.label = "left", .color = report::ColorRole::kMuted};
    const FittedStrike& strike = fit.strikes.front();
    for (std::size_t m = 0; m < strike.spectra.count(); ++m) {
      const double at = strike.spectra.s(m).imag() / (2.0 * std::numbers::pi);
      const Complex y = strike.spectra.responses[k][m], f = strike.spectra.force[m];
      measured.add(at, std::abs(y / f));
      modeled.add(at, std::abs(strike.modeled[k][m] / f));
      left.add(at, std::abs((y - strike.modeled[k][m]) / f));
    }
    figure.panels.push_back(
        {.title = table.names[k],
         .x = {.label = "frequency", .unit = "Hz"},
         .y = {.label = fmt::format("{} over force", name_of(table.model.sensors[k])),
               .unit = fmt::format("{}/N", unit_of(table.model.sensors[k])),
               .logarithmic = true},
         .series = {std::move(left), std::move(measured), std::move(modeled)}});
  }
  return figure;
}

}  // namespace modcal
