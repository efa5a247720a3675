#include "libcalib/optimizers/unbounded_search.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "libcalib/optimizers/tuning.hpp"

namespace modcal {

UnboundedSearch::UnboundedSearch(Evaluator& evaluator)
    : evaluator_(evaluator), z_(evaluator.dimension()), slope_(evaluator.dimension()) {
  for (std::size_t i = 0; i < evaluator.dimension(); ++i) {
    const double center = 0.5 * (evaluator.lower()[i] + evaluator.upper()[i]);
    const double half_width = 0.5 * (evaluator.upper()[i] - evaluator.lower()[i]);
    constexpr double kMost = 1.0 - 2.0 * kInsideBounds;
    const double start = std::clamp(-center / half_width, -kMost, kMost);
    center_.push_back(center);
    half_width_.push_back(half_width);
    phase_.push_back(std::asin(start));
    rate_.push_back(1.0 / (half_width * std::cos(phase_.back())));
  }
}

Evaluator::Trial UnboundedSearch::try_evaluate(std::span<const double> u,
                                               const ObjectiveOutputs& outputs) noexcept {
  assert(u.size() == dimension());
  const std::size_t n = dimension();
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = phase_[i] + rate_[i] * u[i];
    z_[i] = center_[i] + half_width_[i] * std::sin(angle);
    slope_[i] = half_width_[i] * rate_[i] * std::cos(angle);
  }
  const Evaluator::Trial trial = evaluator_.try_evaluate(z_, outputs);
  if (trial != Evaluator::Trial::kFinite) return trial;
  for (std::size_t i = 0; outputs.gradient && i < n; ++i) outputs.gradient[i] *= slope_[i];
  for (std::size_t j = 0; outputs.jacobian && j < residual_count(); ++j) {
    for (std::size_t i = 0; i < n; ++i) outputs.jacobian[j * n + i] *= slope_[i];
  }
  return trial;
}

}  // namespace modcal
