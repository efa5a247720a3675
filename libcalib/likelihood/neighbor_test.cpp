#include "libcalib/likelihood/neighbor_test.hpp"

#include <algorithm>
#include <cmath>

namespace modcal {
namespace {

constexpr double kReach = 6e-3;
constexpr double kMargin = 9.0;
constexpr std::size_t kHalfBand = 128;

// The bins about ω.
ProjectedLikelihood about(const ProjectedLikelihood& likelihood, double omega) {
  const WhitenedRecord& record = likelihood.record();
  const auto center = std::min(static_cast<std::size_t>(omega / record.spacing), record.bins - 1);
  const std::size_t begin = center > kHalfBand ? center - kHalfBand : 0;
  return ProjectedLikelihood(record.slice(begin, 2 * kHalfBand));
}

}  // namespace

std::size_t leave_false_minima(const ProjectedLikelihood& likelihood,
                               const StringUnknowns& unknowns, const QuadraticPrior& prior,
                               Eigen::VectorXd& theta) {
  std::size_t moved = 0;
  for (std::size_t n = 0; n < unknowns.modes(); ++n) {
    const auto i = static_cast<Eigen::Index>(n);
    const ModelPoint point = unknowns.model(theta);
    const double omega = point.basis.omega[n];
    const ProjectedLikelihood local = about(likelihood, omega);
    // Half a width of the damped resonance: finer than its minima are apart.
    const double step = std::max(
        0.5 * (likelihood.record().sigma + point.basis.zeta[n] * omega) / omega, kReach / 16.0);
    double best = local.cost(point) + prior.value(theta) - kMargin;
    double best_shift = 0.0;
    for (double shift = -kReach; shift <= kReach; shift += step) {
      Eigen::VectorXd trial = theta;
      trial[i] += shift;
      const double value = local.cost(unknowns.model(trial)) + prior.value(trial);
      if (value >= best) continue;
      best = value;
      best_shift = shift;
    }
    theta[i] += best_shift;
    if (best_shift != 0.0) ++moved;
  }
  return moved;
}

}  // namespace modcal
