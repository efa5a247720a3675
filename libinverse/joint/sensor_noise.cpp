#include "libinverse/joint/sensor_noise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libinverse/joint/tuning.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

double power_of(Complex value) { return value.real() * value.real() + value.imag() * value.imag(); }

}  // namespace

SensorNoise::SensorNoise(const ModalBasis& basis, double contact, std::size_t samples,
                         double sample_rate, const StringSupport& support,
                         const SensorPair& sensors)
    : fft_(std::clamp<std::size_t>(samples, 1, kNoiseSegment)), samples_(samples) {
  const std::size_t length = fft_.length();
  window_.resize(length);
  for (std::size_t j = 0; j < length; ++j) {
    const double phase = std::numbers::pi * (static_cast<double>(j) + 0.5);
    window_[j] = std::pow(std::sin(phase / static_cast<double>(length)), 2);
    window_power_ += window_[j] * window_[j];
  }
  const FrequencyGrid grid = FrequencyGrid::of_record(length, sample_rate);
  const double top =
      basis.size() > 0 ? *std::max_element(basis.omega.begin(), basis.omega.end()) : 0.0;
  const double nyquist = std::numbers::pi * sample_rate;
  const double from = std::min(1.2 * top, 0.5 * (top + nyquist));
  first_ = static_cast<std::size_t>(std::ceil(from / grid.spacing));
  last_ = static_cast<std::size_t>(0.97 * nyquist / grid.spacing);
  const StringTransfer transfer = string_transfer(basis, contact, grid, support, sensors);
  for (std::size_t k = first_; k < last_; ++k) {
    const Complex left = transfer.reaction[0][k], right = transfer.reaction[1][k];
    const double scale = 1.0 / std::sqrt(power_of(left) + power_of(right));
    const bool known = std::isfinite(scale);
    direction_[0].push_back(known ? scale * left : Complex{});
    direction_[1].push_back(known ? scale * right : Complex{});
  }
}

void SensorNoise::transform(std::span<const double> segment, Workspace& workspace,
                            std::size_t side) const {
  std::vector<Complex>& spectrum = workspace.spectrum[side];
  spectrum.resize(fft_.bins());
  std::transform(segment.begin(), segment.end(), window_.begin(), fft_.samples_in(spectrum).begin(),
                 [](double x, double w) { return x * w; });
  fft_.forward(spectrum);
}

SensorNoiseLevel SensorNoise::estimate(const ReactionPair& reactions, Workspace& workspace) const {
  const bool both = !reactions[0].empty() && !reactions[1].empty();
  SensorNoiseLevel level;
  if (last_ < first_ + kFewestSegmentBins) {
    for (std::size_t r = 0; r < 2; ++r) {
      if (!reactions[r].empty()) level.rms[r] = kSupposedNoise * standard_deviation(reactions[r]);
    }
    return level;
  }
  level.measured = true;
  const std::size_t length = fft_.length();
  const std::size_t segments = std::clamp<std::size_t>(samples_ / length, 1, kMostNoiseSegments);
  std::array<double, 2> power = {0.0, 0.0};
  // Terms of |X_1 H_2 − X_2 H_1|² and of what noise alone would put there.
  double cross = 0.0, of_side[2] = {0.0, 0.0};
  for (std::size_t segment = 0; segment < segments; ++segment) {
    const std::size_t start =
        segments > 1 ? segment * ((samples_ - length) / (segments - 1)) : std::size_t{0};
    for (std::size_t r = 0; r < 2; ++r) {
      if (!reactions[r].empty()) transform(reactions[r].subspan(start, length), workspace, r);
    }
    for (std::size_t k = first_; k < last_; ++k) {
      for (std::size_t r = 0; r < 2; ++r) {
        if (!reactions[r].empty()) power[r] += power_of(workspace.spectrum[r][k]);
      }
      if (!both) continue;
      // Directions, H over √(|H_1|² + |H_2|²), give every bin the same say.
      const Complex left = direction_[0][k - first_], right = direction_[1][k - first_];
      cross += power_of(workspace.spectrum[0][k] * right - workspace.spectrum[1][k] * left);
      of_side[0] += power_of(right);
      of_side[1] += power_of(left);
    }
  }
  const double terms = static_cast<double>((last_ - first_) * segments) * window_power_;
  for (double& value : power) value /= terms;
  const double expected = (of_side[0] * power[0] + of_side[1] * power[1]) * window_power_;
  if (both && expected > 0.0) level.noise_share = std::clamp(cross / expected, kCleanShare, 1.0);
  for (std::size_t r = 0; r < 2; ++r) level.rms[r] = std::sqrt(power[r] * level.noise_share);
  return level;
}

RecordStart record_start(const ReactionPair& reactions, const std::array<double, 2>& rms,
                         const std::array<double, 2>& arrivals, double fundamental,
                         double sample_rate) {
  bool told = false;
  for (std::size_t r = 0; r < 2; ++r) {
    const double time = kBeforeArrival * std::max(0.0, arrivals[r]);
    const std::size_t count =
        std::min(static_cast<std::size_t>(time * sample_rate), reactions[r].size());
    if (count < 4) continue;
    // Of n normal values the variance scatters by √(2/(n − 1)).
    const double by_noise =
        rms[r] * rms[r] * (1.0 + 5.0 * std::sqrt(2.0 / static_cast<double>(count - 1)));
    const double ramp = std::min(1.0, time * fundamental) * standard_deviation(reactions[r]);
    const double least = kStillShare * ramp * ramp;
    if (by_noise > least) continue;
    const double found = standard_deviation(reactions[r].first(count));
    if (found * found > by_noise + least) return RecordStart::kMoving;
    told = true;
  }
  return told ? RecordStart::kRest : RecordStart::kUntold;
}

}  // namespace modcal
