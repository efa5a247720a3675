#include "libcalib/likelihood/bin_weights.hpp"

#include <algorithm>
#include <cmath>

namespace modcal {

std::vector<double> signal_weights(const NoisyRecords& records, double sigma, double highest,
                                   const ProjectedLikelihood& target, const ModelPoint& point) {
  constexpr std::size_t kHalfWindow = 15;
  const ProjectedLikelihood damped(WhitenedRecord::of(records, sigma, highest));
  std::vector<Complex> force;
  std::vector<double> gain;
  damped.evaluate(point, {}, {.force = &force, .gain = &gain});
  // Cumulative sums give every window in one pass.
  std::vector<double> excess(force.size() + 1, 0.0);
  std::vector<double> total(force.size() + 1, 0.0);
  for (std::size_t k = 0; k < force.size(); ++k) {
    excess[k + 1] = excess[k] + std::norm(force[k]) * gain[k] - 1.0;
    total[k + 1] = total[k] + gain[k];
  }
  std::vector<double> own_gain;
  target.evaluate(point, {}, {.gain = &own_gain});
  std::vector<double> weights(own_gain.size());
  const double ratio = target.record().spacing / damped.record().spacing;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const auto center = std::min(
        static_cast<std::size_t>(std::lround(static_cast<double>(k + 1) * ratio)), force.size());
    const std::size_t low = center > kHalfWindow + 1 ? center - 1 - kHalfWindow : 0;
    const std::size_t high = std::min(center + kHalfWindow, force.size());
    const double power = (excess[high] - excess[low]) / (total[high] - total[low]);
    const double signal = own_gain[k] * std::max(power, 0.0);
    weights[k] = signal / (1.0 + signal);
  }
  return weights;
}

}  // namespace modcal
