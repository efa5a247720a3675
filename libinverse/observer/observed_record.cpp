#include "libinverse/observer/observed_record.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libinverse/observer/tuning.hpp"
#include "libinverse/waves/tuning.hpp"
#include "libsim/base/error.hpp"
#include "libsim/signal/fft.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal::observer {
namespace {

// Σ over lags of the squared correlation between bins of a Hann-windowed white spectrum,
// 1 + 2 (2/3)² + 2 (1/6)².
constexpr double kHannSpread = 35.0 / 18.0;

std::vector<double> unweighted(const RealFft& fft, std::vector<Complex> spectrum) {
  std::vector<double> samples = fft.inverse(std::move(spectrum));
  const auto count = static_cast<double>(samples.size());
  for (std::size_t j = 0; j < samples.size(); ++j) {
    samples[j] *= std::exp(kContourWeight * static_cast<double>(j) / count);
  }
  return samples;
}

std::vector<double> after_transient(const std::vector<double>& x) {
  const auto first = static_cast<std::ptrdiff_t>(kBeforeSteady * static_cast<double>(x.size()));
  return {x.begin() + first, x.end()};
}

// Middle of the fullest of equal cells between the 0.2 % and 99.8 % quantiles.
double most_frequent(const std::vector<double>& values) {
  const double low = quantile(values, 0.002), high = quantile(values, 0.998);
  if (!(high > low)) return low;
  const double width = (high - low) / static_cast<double>(kHistogramCells);
  std::vector<std::size_t> count(kHistogramCells, 0);
  for (const double value : values) {
    if (value < low || value >= high) continue;
    ++count[std::min(kHistogramCells - 1, static_cast<std::size_t>((value - low) / width))];
  }
  const auto fullest = std::max_element(count.begin(), count.end()) - count.begin();
  return low + (static_cast<double>(fullest) + 0.5) * width;
}

// The weighted noise has the variance s² Σ_j w_j² in every bin, the force that over s² Σ|H|²/s²;
// the weight's inverse makes it grow with time.
std::vector<double> noise_deviation(const std::vector<double>& precision, std::size_t count,
                                    const FrequencyGrid& grid, double top) {
  double variance = 0.0, power = 0.0;
  for (std::size_t k = 0; k < grid.bins && grid.omega(k) <= 1.02 * top; ++k) {
    if (precision[k] > 0.0) variance += bin_multiplicity(k, count) / precision[k];
  }
  const auto samples = static_cast<double>(count);
  for (std::size_t j = 0; j < count; ++j) {
    power += std::exp(-2.0 * kContourWeight * static_cast<double>(j) / samples);
  }
  std::vector<double> deviation(count, std::sqrt(variance * power) / samples);
  for (std::size_t j = 0; j < count; ++j) {
    deviation[j] *= std::exp(kContourWeight * static_cast<double>(j) / samples);
  }
  return deviation;
}

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
                              std::span<const double> left, std::span<const double> right,
                              const double (&noise_rms)[2]) {
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
    const WhiteNoise noise = std::isnan(noise_rms[r])
                                 ? noise_above(samples, sample_rate, 1.22 * top)
                                 : WhiteNoise{.rms = noise_rms[r]};
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

double offset_deviation(const ObservedRecord& record, int r) {
  const double noise = record.noise[r] / std::sqrt(static_cast<double>(record.silent[r]));
  return std::hypot(noise, kRippleShare * standard_deviation(record.reaction[r]));
}

void negate(std::vector<double>& samples) {
  for (double& value : samples) value = -value;
}

void negate(ObservedRecord& record) {
  record.negated = !record.negated;
  for (int r = 0; r < 2; ++r) {
    record.offset[r] = -record.offset[r];
    negate(record.reaction[r]);
  }
}

LinearEstimate linear_estimate(const ObservedRecord& record) {
  const std::size_t count = record.samples();
  FrequencyGrid grid = FrequencyGrid::of_record(count, record.sample_rate);
  grid.sigma = kContourWeight * record.sample_rate / static_cast<double>(count);
  const RealFft fft(count);
  const double top = 2.0 * std::numbers::pi * record.basis.frequency(record.basis.size() - 1);
  std::vector<Complex> numerator(grid.bins), force(grid.bins), velocity(grid.bins);
  std::vector<double> denominator(grid.bins, 0.0);
  for (int r = 0; r < 2; ++r) {
    std::vector<double> weighted(count);
    for (std::size_t j = 0; j < count; ++j) {
      weighted[j] = (record.reaction[r][j] - record.offset[r]) *
                    std::exp(-kContourWeight * static_cast<double>(j) / static_cast<double>(count));
    }
    const std::vector<Complex> spectrum = fft.forward(weighted);
    const std::vector<Complex> transfer =
        reaction_transfer(record.basis, record.contact, r == 0 ? End::kLeft : End::kRight, grid);
    const double precision = 1.0 / (record.noise[r] * record.noise[r]);
    for (std::size_t k = 0; k < grid.bins; ++k) {
      numerator[k] += precision * std::conj(transfer[k]) * spectrum[k];
      denominator[k] += precision * std::norm(transfer[k]);
    }
  }
  const std::vector<Complex> receptance = contact_receptance(record.basis, record.contact, grid);
  for (std::size_t k = 0; k < grid.bins && grid.omega(k) <= 1.02 * top; ++k) {
    if (!(denominator[k] > 0.0)) continue;
    force[k] = numerator[k] / denominator[k];
    velocity[k] = Complex(grid.sigma, grid.omega(k)) * receptance[k] * force[k];
  }
  return {unweighted(fft, std::move(force)), unweighted(fft, std::move(velocity)),
          noise_deviation(denominator, count, grid, top)};
}

double bow_direction(const LinearEstimate& estimate) {
  return most_frequent(after_transient(estimate.velocity)) < 0.0 ? -1.0 : 1.0;
}

ContactPicture picture_of(const LinearEstimate& estimate) {
  const std::vector<double> velocity = after_transient(estimate.velocity);
  const std::vector<double> force = after_transient(estimate.force);
  ContactPicture picture;
  picture.bow_velocity = most_frequent(velocity);
  picture.slip_speed = picture.bow_velocity - quantile(velocity, 0.01);
  MODCAL_REQUIRE(picture.bow_velocity > 0.0 && picture.slip_speed > 0.0,
                 "the linear estimate shows no stick and slip (most frequent velocity {:g} m/s, "
                 "slip speed {:g} m/s): use a linear estimator for this record",
                 picture.bow_velocity, picture.slip_speed);
  const double sliding = picture.bow_velocity - 0.6 * picture.slip_speed;
  std::vector<double> sliding_force;
  for (std::size_t j = 0; j < velocity.size(); ++j) {
    if (velocity[j] < sliding) sliding_force.push_back(force[j]);
  }
  const double top = quantile(force, 0.995);
  const double dynamic = sliding_force.empty() ? 0.0 : quantile(sliding_force, 0.5);
  // The static part comes from the silent start alone and may be far off on noisy records.
  picture.dynamic_force = std::max(dynamic, 0.1 * std::abs(top));
  picture.static_force = std::max(top, 1.3 * picture.dynamic_force);
  MODCAL_REQUIRE(picture.dynamic_force > 0.0,
                 "the linear estimate shows no friction force (99.5 % quantile {:g} N)", top);
  return picture;
}

}  // namespace modcal::observer
