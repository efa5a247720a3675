#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "libinverse/joint/joint_inversion.hpp"
#include "libinverse/joint/tuning.hpp"
#include "libinverse/noise/noise_model.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

// v_1 and v_2 over those that were read, from bins none of which is far above what it should be.
std::array<double, 2> levels_of(const std::vector<NoiseRow>& rows) {
  std::vector<double> power;
  for (const NoiseRow& row : rows) power.push_back(row.power);
  // A first common factor by the median, which few bins do not move.
  std::array<double, 2> levels;
  levels.fill(quantile(power, 0.5) / std::numbers::ln2);
  for (int round = 0; round < 4 && levels[0] > 0.0 && levels[1] > 0.0; ++round) {
    std::vector<NoiseRow> kept;
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(kept), [&](const NoiseRow& row) {
      return row.power <= kLargestMisfit * (row.by[0] * levels[0] + row.by[1] * levels[1]);
    });
    const NoiseModel model(std::move(kept), {.count = 2});
    Eigen::VectorXd factors = model.white();
    model.fit({}, factors);
    const NoiseCovariance found = model.spectrum({}, factors, 1.0).knots.front().noise;
    levels = {found.left, found.right};
  }
  return levels;
}

}  // namespace

SensorNoiseLevel JointInversion::lowered_noise(const ReactionPair& reactions,
                                               SensorNoiseLevel noise, OffsetRule rule,
                                               JointWorkspace& workspace) const {
  require_record(reactions, noise);
  if (reactions[0].empty() || reactions[1].empty()) return noise;
  if (!(noise.rms[0] > 0.0) || !(noise.rms[1] > 0.0)) return noise;
  JointResult result;
  transform(reactions, rule, workspace, result);
  const double read[2] = {noise.rms[0] * noise.rms[0], noise.rms[1] * noise.rms[1]};
  const std::size_t first = std::max<std::size_t>(
      1, static_cast<std::size_t>(std::ceil(kLowestNoise / grid_.bin_width())));
  const std::size_t last = std::min(
      fft_.bins(), static_cast<std::size_t>(kHighestNoise * sample_rate_ / grid_.bin_width()));
  std::vector<NoiseRow> rows;
  for (std::size_t k = first; k < last; ++k) {
    const Complex left = transfer_[0][k], right = transfer_[1][k];
    const Complex apart = workspace.spectrum[0][k] * right - workspace.spectrum[1][k] * left;
    const double expected = read[0] * std::norm(right) + read[1] * std::norm(left);
    if (!(expected > 0.0)) continue;
    rows.push_back({.octaves = 1.0,
                    .power = std::norm(apart) / weight_power_ / expected,
                    .by = {read[0] * std::norm(right) / expected,
                           read[1] * std::norm(left) / expected, 0.0, 0.0}});
  }
  if (rows.size() < 64) return noise;
  const std::array<double, 2> levels = levels_of(rows);
  for (std::size_t r = 0; r < 2; ++r) noise.rms[r] *= std::sqrt(std::min(levels[r], 1.0));
  return noise;
}

}  // namespace modcal
