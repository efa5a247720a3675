#include <algorithm>
#include <cmath>
#include <numbers>

#include "libinverse/joint/joint_inversion.hpp"
#include "libinverse/joint/tuning.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

// c_k of E c_k = v₁ a_k + v₂ b_k, Var c_k = (E c_k)².
struct CrossRelation {
  std::vector<double> apart, right, left;

  double expected(std::size_t k, const std::array<double, 2>& v) const {
    return v[0] * right[k] + v[1] * left[k];
  }

  // A first common factor by the median, which few bins do not move.
  double common_factor(const std::array<double, 2>& v) const {
    std::vector<double> ratio;
    for (std::size_t k = 0; k < apart.size(); ++k) {
      if (expected(k, v) > 0.0) ratio.push_back(apart[k] / expected(k, v));
    }
    return ratio.empty() ? 1.0 : quantile(ratio, 0.5) / std::numbers::ln2;
  }

  std::array<double, 2> fitted(const std::array<double, 2>& v) const {
    double aa = 0.0, ab = 0.0, bb = 0.0, ac = 0.0, bc = 0.0;
    for (std::size_t k = 0; k < apart.size(); ++k) {
      const double mean = expected(k, v);
      if (!(mean > 0.0) || apart[k] > kLargestMisfit * mean) continue;
      const double a = right[k] / mean, b = left[k] / mean, c = apart[k] / mean;
      aa += a * a;
      ab += a * b;
      bb += b * b;
      ac += a * c;
      bc += b * c;
    }
    const double determinant = aa * bb - ab * ab;
    std::array<double, 2> result = {(bb * ac - ab * bc) / determinant,
                                    (aa * bc - ab * ac) / determinant};
    // One variance below 0: the other explains all.
    if (!(result[0] > 0.0)) result = {0.01 * v[0], bc / bb};
    if (!(result[1] > 0.0)) result = {ac / aa, 0.01 * v[1]};
    return result;
  }
};

}  // namespace

SensorNoiseLevel JointInversion::lowered_noise(const ReactionPair& reactions,
                                               SensorNoiseLevel noise, OffsetRule rule,
                                               JointWorkspace& workspace) const {
  require_record(reactions, noise);
  if (reactions[0].empty() || reactions[1].empty()) return noise;
  if (!(noise.rms[0] > 0.0) || !(noise.rms[1] > 0.0)) return noise;
  JointResult result;
  transform(reactions, rule, workspace, result);
  CrossRelation cross;
  const std::size_t first = std::max<std::size_t>(
      1, static_cast<std::size_t>(std::ceil(kLowestNoise / grid_.bin_width())));
  const std::size_t last = std::min(
      fft_.bins(), static_cast<std::size_t>(kHighestNoise * sample_rate_ / grid_.bin_width()));
  for (std::size_t k = first; k < last; ++k) {
    const Complex left = transfer_[0][k], right = transfer_[1][k];
    const Complex apart = workspace.spectrum[0][k] * right - workspace.spectrum[1][k] * left;
    cross.apart.push_back(std::norm(apart) / weight_power_);
    cross.right.push_back(std::norm(right));
    cross.left.push_back(std::norm(left));
  }
  if (cross.apart.size() < 64) return noise;
  std::array<double, 2> v = {noise.rms[0] * noise.rms[0], noise.rms[1] * noise.rms[1]};
  const double factor = cross.common_factor(v);
  if (!(factor > 0.0)) return noise;
  for (double& variance : v) variance *= factor;
  for (int iteration = 0; iteration < 40; ++iteration) v = cross.fitted(v);
  for (std::size_t r = 0; r < 2; ++r) {
    if (std::isfinite(v[r])) noise.rms[r] = std::min(noise.rms[r], std::sqrt(v[r]));
  }
  return noise;
}

}  // namespace modcal
