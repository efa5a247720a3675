#include "libinverse/observer/observed_record.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"
#include "libsim/signal/fft.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal::observer {

namespace {

// Σ over lags of the squared correlation between bins of a Hann-windowed white spectrum,
// 1 + 2 (2/3)² + 2 (1/6)².
constexpr double kHannSpread = 35.0 / 18.0;

}  // namespace

WhiteNoise noise_above(std::span<const double> samples, double sample_rate, double lowest) {
  const std::size_t count = samples.size();
  std::vector<double> windowed(samples.begin(), samples.end());
  remove_mean(windowed);
  double energy = 0.0;
  for (std::size_t j = 0; j < count; ++j) {
    const double turn = (static_cast<double>(j) + 0.5) / static_cast<double>(count);
    const double window = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * turn);
    windowed[j] *= window;
    energy += window * window;
  }
  const std::vector<Complex> spectrum = RealFft(count).forward(windowed);
  const double spacing = sample_rate / static_cast<double>(count);
  const auto first = static_cast<std::size_t>(std::ceil(lowest / spacing));
  const auto last = static_cast<std::size_t>(0.49 * sample_rate / spacing);
  MODCAL_REQUIRE(
      last >= first + 8,
      "the noise is read between {:g} Hz and {:g} Hz, above the highest mode: sampled at "
      "{:g} Hz the record of {} samples has no such band; use fewer modes or a higher "
      "rate",
      lowest, 0.49 * sample_rate, sample_rate, count);
  double power = 0.0;
  for (std::size_t k = first; k < last; ++k) power += std::norm(spectrum[k]);
  const auto bins = static_cast<double>(last - first);
  return {std::sqrt(power / (bins * energy)), std::sqrt(kHannSpread / bins)};
}

std::size_t silent_samples(const ModalBasis& basis, double contact, End end, double sample_rate) {
  const double speed = 2.0 * basis.length * basis.frequency(0);
  const double path = end == End::kLeft ? contact : basis.length - contact;
  return static_cast<std::size_t>(std::max(0.0, std::floor(path / speed * sample_rate)));
}

double silent_ripple(const ModalBasis& basis, double contact, End end, double sample_rate) {
  const std::size_t count =
      std::max<std::size_t>(1, silent_samples(basis, contact, end, sample_rate));
  const std::vector<double> shape = basis.shape_at(contact);
  const std::vector<double> gain = reaction_gains(basis, end);
  std::vector<double> answer(count, 0.0);
  for (std::size_t n = 0; n < basis.size(); ++n) {
    const double omega = basis.omega[n];
    const double share = gain[n] * shape[n] / (basis.mass[n] * omega * omega);
    for (std::size_t k = 0; k < count; ++k) {
      const double time = static_cast<double>(k) / sample_rate;
      answer[k] += share * (1.0 - std::exp(-basis.zeta[n] * omega * time) * std::cos(omega * time));
    }
  }
  return std::hypot(mean(answer),
                    standard_deviation(answer) / std::sqrt(static_cast<double>(count)));
}

ObservedRecord observe_record(const ModalBasis& basis, double contact, double sample_rate,
                              std::span<const double> left, std::span<const double> right) {
  MODCAL_REQUIRE(left.size() == right.size(),
                 "the reactions have {} and {} samples: the observer needs both, equally long",
                 left.size(), right.size());
  const double periods = static_cast<double>(left.size()) / sample_rate * basis.frequency(0);
  MODCAL_REQUIRE(periods >= 4.0,
                 "the record of {} samples holds {:.3g} periods: the observer needs at least 4",
                 left.size(), periods);
  ObservedRecord record;
  record.basis = basis;
  record.contact = contact;
  record.sample_rate = sample_rate;
  const double top = basis.frequency(basis.size() - 1);
  for (int r = 0; r < 2; ++r) {
    const std::span<const double> samples = r == 0 ? left : right;
    for (std::size_t j = 0; j < samples.size(); ++j) {
      MODCAL_REQUIRE(std::isfinite(samples[j]),
                     "sample {} of the reaction at {} is {:g}: cut the record before it or repair "
                     "it",
                     j, r == 0 ? "x = 0" : "x = L", samples[j]);
    }
    const double deviation = standard_deviation(samples);
    MODCAL_REQUIRE(deviation > 0.0, "the reaction at {} is constant: nothing moved",
                   r == 0 ? "x = 0" : "x = L");
    record.reaction[r].assign(samples.begin(), samples.end());
    const WhiteNoise noise = noise_above(samples, sample_rate, 1.22 * top);
    record.raw_noise[r] = noise.rms;
    record.noise_deviation[r] = noise.deviation;
    record.noise[r] = std::max(record.raw_noise[r], kNoiseFloor * deviation);
    record.silent[r] =
        silent_samples(basis, contact, r == 0 ? End::kLeft : End::kRight, sample_rate);
    // A contact closer to the end than one sample leaves nothing but the sample at t = 0.
    record.silent[r] = std::clamp<std::size_t>(record.silent[r], 1, samples.size());
    record.offset[r] = mean(samples.first(record.silent[r]));
  }
  return record;
}

double silent_deviation(const ObservedRecord& record, End end, double bow_velocity) {
  const ModalBasis& basis = record.basis;
  const auto r = static_cast<std::size_t>(end);
  const double noise = record.noise[r] / std::sqrt(static_cast<double>(record.silent[r]));
  const double impedance = basis.tension / (2.0 * basis.length * basis.frequency(0));
  const double ripple = silent_ripple(basis, record.contact, end, record.sample_rate);
  return std::hypot(noise, 2.0 * impedance * bow_velocity * ripple);
}

void negate(ObservedRecord& record) {
  record.negated = !record.negated;
  for (int r = 0; r < 2; ++r) {
    record.offset[r] = -record.offset[r];
    for (double& value : record.reaction[r]) value = -value;
  }
}

}  // namespace modcal::observer
