// What the two reactions contradict each other by, and what that says of the force's variance.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "libinverse/joint/joint_inversion.hpp"
#include "libinverse/joint/joint_kernels.hpp"
#include "libinverse/joint/tuning.hpp"

namespace modcal {

// A mean over n samples errs by √(v/n), and that constant has the spectrum f_s/(σ + iω): at low
// frequencies it parts the sides by more than their noise. Returns by how much the sum has fallen.
double JointInversion::allow_for_offsets(OffsetRule rule, std::span<double> misfit) const {
  if (rule == OffsetRule::kNone) return 0.0;
  const std::size_t least = std::min(samples_before_arrival(0), samples_before_arrival(1));
  if (least == 0) return 0.0;
  const double power = sample_rate_ * sample_rate_ / (static_cast<double>(least) * weight_power_);
  const double spacing = 2.0 * std::numbers::pi * grid_.bin_width();
  double fallen = 0.0;
  for (std::size_t k = 0; k < misfit.size(); ++k) {
    const double omega = spacing * static_cast<double>(k);
    const double share = power / (model_.sigma * model_.sigma + omega * omega);
    if (share < 1e-3) break;
    const double allowed = misfit[k] / (1.0 + share);
    fallen += misfit[k] - allowed;
    misfit[k] = allowed;
  }
  return fallen;
}

void JointInversion::compare_sides(const Weights& weights, const JointMethod& method,
                                   JointWorkspace& workspace, JointResult& result) const {
  const bool keep_misfit = method.variances || method.outputs.side_misfit;
  result.side_misfit.clear();
  result.misfit = std::numeric_limits<double>::quiet_NaN();
  workspace.misfit.clear();
  workspace.side_error.clear();
  const auto& inverse = weights.inverse_variance;
  if (inverse[0] == 0.0 || inverse[1] == 0.0) return;
  const std::size_t bins = fft_.bins();
  workspace.misfit.resize(bins);
  const double sum =
      joint_kernels().cross_misfit({1.0 / inverse[0], 1.0 / inverse[1]}, 1.0 / weight_power_,
                                   transfer_, workspace.spectrum, workspace.misfit);
  workspace.side_error.assign(workspace.misfit.begin(), workspace.misfit.end());
  const double excess = allow_for_offsets(method.offset, workspace.misfit);
  result.misfit = (sum - excess) / static_cast<double>(bins);
  if (!std::isnan(method.band_limit)) {
    // Above the limit nothing is identified, and the model need not hold.
    const double within = std::floor(method.band_limit / grid_.bin_width()) + 1.0;
    const auto count = static_cast<std::ptrdiff_t>(std::min(within, static_cast<double>(bins)));
    result.misfit =
        std::accumulate(workspace.misfit.begin(), workspace.misfit.begin() + count, 0.0) /
        static_cast<double>(count);
  }
  const bool contradict =
      model_.truncation == Truncation::kTransient || !(result.misfit < kSidesContradict);
  const double half = std::max(4.0, 0.25 * kMisfitWidth / grid_.bin_width());
  if (!contradict) workspace.side_error.clear();
  // What the noise of the offsets, too, does not put there, in units of the noise.
  for (std::size_t k = 0; k < workspace.side_error.size(); ++k) {
    double& error = workspace.side_error[k];
    error = workspace.misfit[k] > 1.0 ? error * (1.0 - 1.0 / workspace.misfit[k]) : 0.0;
  }
  if (contradict || keep_misfit) {
    workspace.scratch.resize(bins);
    smooth_power(workspace.misfit, workspace.scratch, half, 0.0);
  }
  if (contradict) find_side_errors(weights, half, workspace);
  if (keep_misfit) result.side_misfit = workspace.misfit;
}

// With u = q_2/q, the right sensor's share in what is known of F, an error of variance s v_1 of the
// left one alone makes a misfit of 1 + s u, and F err by s (1 − u) of its variance.
void JointInversion::find_side_errors(const Weights& weights, double half,
                                      JointWorkspace& workspace) const {
  std::vector<double>&share = workspace.terms[0], &around = workspace.terms[1];
  share.resize(fft_.bins());
  for (std::size_t k = 0; k < share.size(); ++k) {
    const double left = weights.inverse_variance[0] * std::norm(transfer_[0][k]);
    const double right = weights.inverse_variance[1] * std::norm(transfer_[1][k]);
    share[k] = left + right > 0.0 ? right / (left + right) : 0.5;
  }
  around.assign(share.begin(), share.end());
  smooth_power(around, workspace.scratch, half, 0.0);
  for (std::size_t k = 0; k < share.size(); ++k) {
    double& error = workspace.side_error[k];
    const double excess = std::exchange(error, 0.0);
    if (!(workspace.misfit[k] > kSidesApart)) continue;
    const double seen[2] = {share[k], 1.0 - share[k]}, usual[2] = {around[k], 1.0 - around[k]};
    for (std::size_t r = 0; r < 2 && excess > 0.0; ++r) {  // 0/0 where a sensor is blind
      const double read =
          weights.inverse_variance[r] / weight_power_ * std::norm(workspace.spectrum[r][k]);
      const double own = excess / std::max(seen[r], kBlindShare * usual[r]);
      error += (1.0 - seen[r]) * std::min(own, read);
    }
    // What both err by alike shows beside the bin.
    error = std::max(error, workspace.misfit[k] - 1.0);
  }
}

void JointInversion::widen_by_misfit(bool keep, JointWorkspace& workspace,
                                     JointResult& result) const {
  result.force_excess.assign(keep ? fft_.bins() : 0, 0.0);
  result.velocity_excess.assign(keep ? fft_.bins() : 0, 0.0);
  double known = 0.0, slow = 0.0;
  for (std::size_t k = 0; k < workspace.side_error.size(); ++k) {
    double& variance = workspace.variance[k];
    const double excess = workspace.side_error[k] * workspace.gain[k] * variance * variance;
    known += variance;
    if (static_cast<double>(k) * grid_.bin_width() < fundamental_) slow += excess;
    variance += excess;
    if (!keep) continue;
    result.force_excess[k] = excess;
    result.velocity_excess[k] = excess * std::norm(mobility_[k]);
  }
  result.slow_widening = slow > 0.0 ? std::sqrt(1.0 + slow / known) : 1.0;
}

void JointInversion::widen_by_bending(JointWorkspace& workspace, JointResult& result) const {
  double known = 0.0, open = 0.0;
  for (std::size_t k = workspace.level_known ? 0 : 1; k < bending_share_.size(); ++k) {
    const double excess = bending_share_[k] * std::norm(workspace.spectrum[0][k]) / weight_power_;
    known += workspace.variance[k];
    open += excess;
    workspace.variance[k] += excess;
    if (result.force_excess.empty()) continue;
    result.force_excess[k] += excess;
    result.velocity_excess[k] += excess * std::norm(mobility_[k]);
  }
  result.bending_widening = open > 0.0 ? std::sqrt(1.0 + open / known) : 1.0;
}

}  // namespace modcal
