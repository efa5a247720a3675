#include "libinverse/structure/strikes/strike_weights.hpp"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "libinverse/structure/strikes/strike_fit.hpp"
#include "libinverse/structure/tuning.hpp"

namespace modcal {

double mean_power(const std::vector<Complex>& spectrum) {
  double sum = 0.0;
  for (const Complex& x : spectrum) sum += std::norm(x);
  return sum / static_cast<double>(spectrum.size());
}

BinWeights weights_of(const ContourSpectra& spectra, double share) {
  BinWeights result;
  const double spacing = spectra.grid.spacing / (2.0 * std::numbers::pi);
  for (const std::vector<Complex>& response : spectra.responses) {
    std::vector<double> power;
    for (const Complex& y : response) power.push_back(std::norm(y));
    std::vector<double>& weights = result.emplace_back();
    const double floor = 0.01 * mean_power(response);
    for (const double p : smoothed(power, spacing, 3.0)) {
      weights.push_back(1.0 / (share * std::sqrt(p + floor)));
    }
  }
  return result;
}

SensorScatter scatter_of(const std::vector<double>& left, const std::vector<double>& modal,
                         double noise_power, double correlated) {
  const auto n = static_cast<Eigen::Index>(left.size());
  const Eigen::Map<const Eigen::ArrayXd> r(left.data(), n), power(modal.data(), n);
  const double unit = std::max(1e-300, power.maxCoeff()), mean = std::max(1e-300, r.mean());
  const Eigen::ArrayXd x = power / unit;
  double slope = mean / std::max(1e-300, x.mean()), level = mean;
  Eigen::ArrayXd expected;
  for (int step = 0; step < 200; ++step) {
    expected = slope * x + level;
    const Eigen::ArrayXd score = r / expected.square(), all = expected.inverse();
    slope *= (x * score).sum() / (x * all).sum();
    level *= score.sum() / all.sum();
  }
  const double gain =
      static_cast<double>(n) * (std::log(mean) + 1.0) - (expected.log() + r / expected).sum();
  if (!(2.0 * gain / correlated > 4.0)) slope = 0.0, level = mean;
  return {.modal = std::sqrt(slope / unit), .noise = std::sqrt(level / noise_power)};
}

std::vector<double> made_by_modes(const ContourSpectra& spectra, const ModalModel& model,
                                  std::size_t sensor) {
  std::vector<double> made;
  for (std::size_t m = 0; m < spectra.count(); ++m) {
    made.push_back(std::norm(spectra.force[m]) * modal_power(model, sensor, spectra.s(m)));
  }
  return made;
}

BinWeights weights_of(const ContourSpectra& spectra, const ModalModel& model,
                      const std::vector<SensorScatter>& scatters) {
  BinWeights result;
  for (std::size_t k = 0; k < scatters.size(); ++k) {
    const auto [modal, noise] = scatters[k];
    // Rounding, where nothing else is left; a channel of zeros weighs something.
    const double least = 1e-20 * mean_power(spectra.responses[k]) + 1e-200;
    const double white = noise * noise * spectra.noise_power() + least;
    std::vector<double>& weights = result.emplace_back();
    for (const double made : made_by_modes(spectra, model, k)) {
      weights.push_back(1.0 / std::sqrt(modal * modal * made + white));
    }
  }
  return result;
}

std::string StrikeFit::rejection(std::span<const std::string> names) const {
  double most = 0.5;
  std::size_t worst = strikes.size();
  for (std::size_t i = 0; i < strikes.size(); ++i) {
    const double left = std::ranges::max(strikes[i].residuals);
    if (left > most) most = left, worst = i;
  }
  if (worst == strikes.size()) return {};
  return fmt::format(
      "rejected: the modes leave {:.0f} % of a response{}: compare the channels and their units, "
      "and whether the structure rests when the record begins; a smaller contour tells more modes",
      100.0 * most, worst < names.size() ? fmt::format(" of {}", names[worst]) : "");
}

std::string StrikeFit::without_damping() const {
  for (std::size_t n = 0; n < table.model.poles.size(); ++n) {
    const double f = table.frequency(n);
    // Beyond the band a pole stands for what no other explains, of any damping.
    if (f < table.low || f > table.high) continue;
    if (table.model.poles[n].zeta > 1.01 * kLeastDampingRatio) continue;
    return fmt::format("rejected: no damping is left of the mode at {:.5g} Hz", f);
  }
  return {};
}

}  // namespace modcal
