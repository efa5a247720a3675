#include "experiments/kinds/structure/modes_outcome.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "experiments/kinds/structure/structure_files.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

// ln f of a mode in one strike alone, over that in all; the median of the modes.
double shift_of(const StrikeFit& fit, const FittedStrike& strike) {
  std::vector<double> shifts;
  for (std::size_t n = 0; n < strike.poles.size(); ++n) {
    shifts.push_back(std::log(strike.poles[n].omega / fit.table.model.poles[n].omega));
  }
  return quantile(shifts, 0.5);
}

}  // namespace

void ModesOutcome::visit(ResultVisitor& visitor) const {
  const StructureTable& table = fit.table;
  std::vector<std::size_t> modes(table.model.poles.size()), sensors(table.names.size());
  for (std::size_t n = 0; n < modes.size(); ++n) modes[n] = n;
  for (std::size_t k = 0; k < sensors.size(); ++k) sensors[k] = k;
  visitor.rows(
      {.key = "modes",
       .table = "modes",
       .name = "Modes",
       .meaning = fit.strikes.size() > 1
                      ? "Pairs of poles common to all sensors and strikes. Another strike of the "
                        "structure differs from them by the standard deviations, which are told "
                        "by how far these differ."
                      : "Pairs of poles common to all sensors, with the standard deviations "
                        "of the fit. Another strike may differ by more than these: other_strikes "
                        "tell how far."},
      modes, [&](ResultVisitor& row, std::size_t n) {
        const double frequency = table.frequency(n);
        row({.key = "n", .name = "mode"}, n + 1);
        row({.key = "f_hz", .name = "frequency", .unit = "Hz", .format = "{:.6g}"}, frequency);
        row({.key = "f_sd_hz", .name = "its deviation", .unit = "Hz", .format = "{:.2g}"},
            frequency * table.frequency_deviations[n]);
        row({.key = "zeta", .name = "damping ratio"}, table.model.poles[n].zeta);
        row({.key = "zeta_sd", .name = "its deviation", .format = "{:.2g}"},
            table.model.poles[n].zeta * table.damping_deviations[n]);
        row({.key = "stands_in", .shown = ResultVisitor::kInJson},
            std::ranges::count(fit.stand_ins, n) > 0);
      });
  visitor.rows(
      {.key = "sensors",
       .table = "sensors",
       .name = "Sensors",
       .meaning = "What the model leaves of each response, and what that says of the "
                  "model's scatter about a mode and of the noise."},
      sensors, [&](ResultVisitor& row, std::size_t k) {
        row({.key = "channel"}, table.names[k]);
        row({.key = "kind"}, name_of(table.model.sensors[k]));
        row({.key = "left", .name = "left of the response", .format = "{:.3g}"}, fit.residuals[k]);
        row({.key = "scatter", .format = "{:.3g}"}, table.scatters[k].modal);
        row({.key = "noise_rms", .name = "noise", .format = "{:.3g}"}, table.scatters[k].noise);
      });
  visit_strikes(visitor);
  visitor.rows({.key = "steps", .shown = ResultVisitor::kInJson}, fit.steps,
               [](ResultVisitor& row, const ModeCount& step) {
                 row({.key = "modes"}, step.modes);
                 row({.key = "misfit"}, step.misfit);
                 row({.key = "criterion"}, step.criterion);
               });
  visitor({.key = "contour_per_s"}, fit.strikes.front().spectra.grid.sigma);
  visitor({.key = "rest_s"}, known(rest));
  visitor({.key = "misfit"}, fit.misfit);
}

void ModesOutcome::visit_strikes(ResultVisitor& visitor) const {
  if (fit.strikes.size() < 2) return;
  std::vector<std::size_t> strikes(fit.strikes.size());
  std::iota(strikes.begin(), strikes.end(), std::size_t{0});
  visitor.rows(
      {.key = "strikes",
       .table = "strikes",
       .name = "Strikes",
       .meaning = "What the modes of all strikes leave of each, at most, and by how much its own "
                  "frequencies lie above those of all (the median of the modes)."},
      strikes, [&](ResultVisitor& row, std::size_t i) {
        row({.key = "strike"}, names[i]);
        row({.key = "left", .name = "left of a response", .format = "{:.3g}"},
            std::ranges::max(fit.strikes[i].residuals));
        row({.key = "shift", .name = "frequencies above", .format = "{:.2g}"},
            shift_of(fit, fit.strikes[i]));
      });
  visitor({.key = "frequency_scatter"}, fit.frequency_scatter);
  visitor({.key = "damping_scatter"}, fit.damping_scatter);
}

std::string sentence_of(const StrikeFit& fit, const FitModesOptions& options) {
  const auto [least, most] = std::ranges::minmax(fit.residuals);
  const auto& poles = fit.table.model.poles;
  const auto inside = std::ranges::count_if(poles, [&options](const ModalPole& pole) {
    const double frequency = pole.omega / (2.0 * std::numbers::pi);
    return frequency >= options.low && frequency <= options.high;
  });
  std::string text = fmt::format("{} modes", poles.size());
  if (inside < std::ssize(poles)) text += fmt::format(", {} of them", inside);
  text += fmt::format(
      " between {:g} and {:g} Hz; the model leaves {:.2g} to {:.2g} % of the responses\n",
      options.low, options.high, 100.0 * least, 100.0 * most);
  if (fit.strikes.size() > 1) {
    text += fmt::format(
        "from {} to {} frequencies differ by {:.2g} %, damping ratios by {:.2g} % (medians of "
        "{})\n",
        options.has_functions ? "session" : "strike", options.has_functions ? "session" : "strike",
        100.0 * fit.frequency_scatter, 100.0 * fit.damping_scatter, fit.strikes.size());
  }
  return text;
}

}  // namespace modcal
