#include "libcalib/optimizers/staged/pluck_search.hpp"

#include <cmath>

#include "libcalib/identifiability/tuning.hpp"
#include "libcalib/optimizers/staged/tuning.hpp"

namespace modcal {

double loudest_shift(std::span<const std::shared_ptr<const PluckLikelihood>> plucks,
                     const ModelPoint& model, std::size_t mode) {
  const double zeta = model.basis.zeta[mode];
  const auto power = [&](double shift) {
    const double omega = model.basis.omega[mode] * std::exp(shift);
    double sum = 0.0;
    for (const auto& pluck : plucks) {
      const Complex rate(-zeta * omega, omega * std::sqrt(1.0 - zeta * zeta));
      sum += pluck->power_about(std::exp(rate / pluck->record().sample_rate), omega);
    }
    return sum;
  };
  double best = power(0.0) + kPlaceMargin, found = 0.0;
  double shift = -kNeighborReach;
  while (shift <= kNeighborReach) {
    if (const double value = power(shift); value > best) {
      best = value;
      found = shift;
    }
    shift += 0.5 * zeta;
  }
  return found;
}

}  // namespace modcal
