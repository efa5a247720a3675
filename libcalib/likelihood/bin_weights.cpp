#include "libcalib/likelihood/bin_weights.hpp"

#include <algorithm>
#include <cmath>

namespace modcal {
namespace {

// Sums over windows of bins by cumulative sums: every window in one step.
class Windows {
 public:
  explicit Windows(const std::vector<double>& values) : cumulative_(values.size() + 1, 0.0) {
    for (std::size_t k = 0; k < values.size(); ++k) cumulative_[k + 1] = cumulative_[k] + values[k];
  }
  double sum(std::size_t center, std::size_t half) const {
    const std::size_t low = center > half ? center - half : 0;
    return cumulative_[std::min(center + half + 1, cumulative_.size() - 1)] - cumulative_[low];
  }

 private:
  std::vector<double> cumulative_;
};

constexpr std::size_t kLine = 2;    // bins either side of a line of the force
constexpr std::size_t kFloor = 30;  // and of a stretch between lines
constexpr double kProof = 15.0;     // excess of five bins that noise has once in 60 000

// Power of the force in each bin: its lines by themselves, what is between them smoothed widely, so
// that noise does not choose its own weight.
std::vector<double> force_power(const std::vector<Complex>& force,
                                const std::vector<double>& gain) {
  std::vector<double> excess(force.size());
  for (std::size_t k = 0; k < force.size(); ++k) {
    excess[k] = std::norm(force[k]) * gain[k] - 1.0;
  }
  const Windows near_excess(excess), near_gain(gain);
  std::vector<double> between(force.size()), between_gain(force.size());
  for (std::size_t k = 0; k < force.size(); ++k) {
    if (near_excess.sum(k, kLine) > kProof) continue;
    between[k] = excess[k];
    between_gain[k] = gain[k];
  }
  const Windows wide_excess(between), wide_gain(between_gain);
  std::vector<double> power(force.size());
  for (std::size_t k = 0; k < force.size(); ++k) {
    const bool line = near_excess.sum(k, kLine) > kProof;
    const double total = line ? near_gain.sum(k, kLine) : wide_gain.sum(k, kFloor);
    const double found = line ? near_excess.sum(k, kLine) : wide_excess.sum(k, kFloor);
    power[k] = total > 0.0 ? std::max(found / total, 0.0) : 0.0;
  }
  return power;
}

}  // namespace

std::vector<double> signal_weights(const NoisyRecords& records, double sigma, double highest,
                                   const ProjectedLikelihood& target, const ModelPoint& point) {
  const ProjectedLikelihood damped(WhitenedRecord::of(records, sigma, highest));
  std::vector<Complex> force;
  std::vector<double> gain, own_gain;
  damped.evaluate(point, {}, {.force = &force, .gain = &gain});
  target.evaluate(point, {}, {.gain = &own_gain});
  const std::vector<double> power = force_power(force, gain);
  std::vector<double> weights(own_gain.size());
  const double ratio = target.record().spacing / damped.record().spacing;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const auto place = static_cast<std::size_t>(std::lround(static_cast<double>(k + 1) * ratio));
    const double signal = own_gain[k] * power[std::clamp<std::size_t>(place, 1, power.size()) - 1];
    weights[k] = signal / (1.0 + signal);
  }
  return weights;
}

}  // namespace modcal
