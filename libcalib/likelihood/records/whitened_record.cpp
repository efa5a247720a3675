#include "libcalib/likelihood/records/whitened_record.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcalib/likelihood/records/noise_level.hpp"
#include "libsim/base/error.hpp"
#include "libsim/base/random.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

using std::numbers::pi;

// Largest even number ≤ length without a prime factor above 5: such transforms are fast.
std::size_t fast_length(std::size_t length) {
  for (std::size_t candidate = length - length % 2; candidate >= 2; candidate -= 2) {
    std::size_t rest = candidate;
    for (const std::size_t prime : {2u, 3u, 5u}) {
      while (rest % prime == 0) rest /= prime;
    }
    if (rest == 1) return candidate;
  }
  return length;
}

std::size_t cut_length(const NoisyRecords& records, double sigma) {
  if (sigma == 0.0) return records.samples();
  const double wanted = std::round(8.0 / sigma * records.sample_rate);
  if (wanted >= static_cast<double>(records.samples())) return records.samples();
  return fast_length(std::max<std::size_t>(static_cast<std::size_t>(wanted), 2));
}

// first·step^k for k < count, step = exp(rate), with two exponentials for every 256.
std::vector<Complex> powers(Complex first, Complex rate, std::size_t count) {
  constexpr std::size_t kRun = WhitenedRecord::kBlock;
  Complex run[kRun];
  for (std::size_t k = 0; k < kRun; ++k) run[k] = std::exp(rate * static_cast<double>(k));
  std::vector<Complex> result(count);
  Complex begin;
  for (std::size_t k = 0; k < count; ++k) {
    if (k % kRun == 0) begin = first * std::exp(rate * static_cast<double>(k));
    result[k] = begin * run[k % kRun];
  }
  return result;
}

// y_r at the bins k = 1 … K_b; `decay` holds exp(−σt), nothing at σ = 0.
void whiten(std::span<const double> samples, std::span<const double> decay, double scale,
            std::size_t bins, PlanarVector& out) {
  std::vector<double> damped(decay.size());
  for (std::size_t j = 0; j < damped.size(); ++j) damped[j] = samples[j] * decay[j];
  const RealFft fft(samples.size());
  const std::vector<Complex> spectrum = fft.forward(decay.empty() ? samples : damped);
  for (std::size_t k = 0; k < bins; ++k) out.set(k, spectrum[k + 1] * scale);
}

// Draws that depend on seed and number alone are kept by the thread: every fit asks for the same.
std::span<const double> noise_draw(std::uint64_t seed, std::size_t count) {
  struct Draw {
    std::uint64_t seed = 0;
    std::vector<double> numbers;
  };
  static thread_local std::array<Draw, 4> kept;
  Draw& draw = kept[seed % kept.size()];
  if (draw.numbers.size() != count || draw.seed != seed) {
    draw = {seed, std::vector<double>(count)};
    fill_standard_normal(StreamKey(seed).with("likelihood noise"), draw.numbers);
  }
  return draw.numbers;
}

}  // namespace

NoisyRecords NoisyRecords::of_data(const CalibrationData& data, const ModalBasis& basis,
                                   std::array<double, 2> deviation) {
  data.require_valid();
  data.require_motion();
  MODCAL_REQUIRE(data.has_both(),
                 "the joint likelihood compares both reactions, and one is missing");
  NoisyRecords records{.sample_rate = data.sample_rate};
  const RealFft fft(data.samples);
  for (const End end : {End::kLeft, End::kRight}) {
    const auto r = static_cast<std::size_t>(end);
    records.reactions[r] = fft.inverse(data.reaction(end));
    records.deviation[r] = deviation[r];
    if (std::isnan(deviation[r])) {
      const NoiseBand band = NoiseBand::above(basis, data.sample_rate, data.samples);
      records.deviation[r] = noise_deviation(records.reactions[r], band);
    }
    MODCAL_REQUIRE(records.deviation[r] > 0.0 && std::isfinite(records.deviation[r]),
                   "noise of {:g} N in the {} reaction: the likelihood needs noise > 0; state "
                   "{}_noise or record at a higher rate, whose band above the modes shows it",
                   records.deviation[r], r == 0 ? "left" : "right", r == 0 ? "left" : "right");
  }
  return records;
}

WhitenedRecord WhitenedRecord::of(const NoisyRecords& records, double sigma, double highest) {
  MODCAL_REQUIRE(sigma >= 0.0 && std::isfinite(sigma), "damping {:g} 1/s must be >= 0", sigma);
  WhitenedRecord record;
  const std::size_t length = cut_length(records, sigma);
  const FrequencyGrid grid = FrequencyGrid::of_record(length, records.sample_rate);
  record.bins = bins_between(grid, 0.0, std::min(highest, 0.98 * pi * records.sample_rate)).size();
  MODCAL_REQUIRE(record.bins >= 1, "no bin below {:g} Hz in a record of {} samples",
                 highest / (2.0 * pi), length);
  record.sigma = sigma;
  record.spacing = grid.spacing;
  record.sample_rate = records.sample_rate;
  record.deviation = records.deviation;
  for (const double line : records.lines) {
    const double omega = 2.0 * pi * line;
    if (omega < record.spacing * static_cast<double>(record.bins)) record.lines.push_back(omega);
  }
  if (sigma == 0.0) record.signals = records.signals;
  const std::size_t padded = (record.bins + kBlock - 1) / kBlock * kBlock;
  record.left = record.right = record.delay = record.offset = PlanarVector(padded);
  record.root_weight.assign(padded, 0.0);
  std::fill_n(record.root_weight.begin(), record.bins, 1.0);

  std::vector<double> decay;
  double energy = static_cast<double>(length);
  if (sigma > 0.0) {
    energy = 0.0;
    for (const Complex number : powers(1.0, -sigma / records.sample_rate, length)) {
      decay.push_back(number.real());
      energy += number.real() * number.real();
    }
  }
  const double norm = 1.0 / std::sqrt(energy);
  const auto whiten_end = [&](std::span<const double> reaction, std::size_t r, PlanarVector& out) {
    whiten(reaction.first(length), decay, norm / records.deviation[r], record.bins, out);
  };
  whiten_end(records.reactions[0], 0, record.left);
  whiten_end(records.reactions[1], 1, record.right);
  for (std::size_t k = 0; k < record.bins; ++k) {
    record.energy += std::norm(record.left.at(k)) + std::norm(record.right.at(k));
  }
  if (sigma == 0.0 && !records.on_bridge.empty()) {
    record.on_bridge = PlanarVector(padded);
    whiten_end(records.on_bridge, 1, record.on_bridge);
    record.body = records.body;
  }
  const double rest = sigma == 0.0 ? 1.0 : decay.back() * std::exp(-sigma / records.sample_rate);
  const Complex turn(0.0, -record.spacing / records.sample_rate);
  const std::vector<Complex> delays =
      powers(std::exp(turn - sigma / records.sample_rate), turn, padded);
  for (std::size_t k = 0; k < padded; ++k) {
    record.delay.set(k, delays[k]);
    if (sigma > 0.0) record.offset.set(k, norm * (1.0 - rest) / (1.0 - delays[k]));
  }
  record.place_bins();
  record.place_lines();
  if (!records.noise.white()) record.take_noise(records.noise);
  return record;
}

void WhitenedRecord::take_noise(const NoiseSpectrum& spectrum) {
  left_noise.resize(root_weight.size());
  right_noise.resize(root_weight.size());
  mixed_noise.resize(root_weight.size());
  for (std::size_t k = 0; k < root_weight.size(); ++k) {
    const NoiseCovariance noise = spectrum.at(omega[k] / (2.0 * pi));
    left_noise[k] = noise.left;
    right_noise[k] = noise.right;
    mixed_noise[k] = noise.mixed;
  }
}

double WhitenedRecord::block_place(double k) {
  constexpr double kHalf = 0.5 * static_cast<double>(kBlock - 1);
  return (k - kHalf) / kHalf;
}

double WhitenedRecord::node_place(std::size_t j) {
  return -std::cos(pi * (static_cast<double>(j) + 0.5) / static_cast<double>(kNodes));
}

void WhitenedRecord::place_bins() {
  omega.resize(root_weight.size());
  for (std::size_t k = 0; k < omega.size(); ++k) {
    omega[k] = spacing * static_cast<double>(first + k);
  }
  node_omega.resize(blocks() * kNodes);
  node_delay = PlanarVector(node_omega.size());
  const double half = 0.5 * static_cast<double>(kBlock - 1);
  for (std::size_t i = 0; i < node_omega.size(); ++i) {
    const std::size_t block = i / kNodes;
    const auto begin = static_cast<double>(first + block * kBlock);
    node_omega[i] = spacing * (begin + half * (1.0 + node_place(i % kNodes)));
    node_delay.set(i, std::polar(std::exp(-sigma / sample_rate), -node_omega[i] / sample_rate));
  }
}

void WhitenedRecord::place_lines() {
  if (lines.empty()) return;
  std::vector<LineWaves> placed;
  for (const double line : lines) {
    placed.push_back(line_waves(line, {.sigma = sigma,
                                       .sample_rate = sample_rate,
                                       .samples = 2.0 * pi * sample_rate / spacing,
                                       .count = bins,
                                       .delay = delay}));
  }
  waves = std::make_shared<const std::vector<LineWaves>>(std::move(placed));
}

WhitenedRecord WhitenedRecord::slice(std::size_t begin, std::size_t count) const {
  MODCAL_REQUIRE(begin < bins && count >= 1, "bins {} ... of a record of {} bins", begin, bins);
  WhitenedRecord part{.bins = std::min(count, bins - begin),
                      .sigma = sigma,
                      .spacing = spacing,
                      .first = first + begin,
                      .sample_rate = sample_rate,
                      .deviation = deviation,
                      .energy = energy,
                      .lines = lines};
  const std::size_t padded = (part.bins + kBlock - 1) / kBlock * kBlock;
  part.left = part.right = part.delay = part.offset = PlanarVector(padded);
  part.root_weight.assign(padded, 0.0);
  for (std::size_t k = 0; k < part.bins; ++k) {
    part.left.set(k, left.at(begin + k));
    part.right.set(k, right.at(begin + k));
    part.delay.set(k, delay.at(begin + k));
    part.offset.set(k, offset.at(begin + k));
    part.root_weight[k] = root_weight[begin + k];
  }
  if (!white()) {
    const auto cut = [&](const AlignedVector& all, double filling) {
      AlignedVector own(padded, filling);
      std::copy_n(all.begin() + static_cast<long>(begin), part.bins, own.begin());
      return own;
    };
    part.left_noise = cut(left_noise, 1.0);
    part.right_noise = cut(right_noise, 1.0);
    part.mixed_noise = cut(mixed_noise, 0.0);
  }
  for (const SignalColumn& signal : signals) {
    SignalColumn& own =
        part.signals.emplace_back(SignalColumn{PlanarVector(padded), PlanarVector(padded)});
    for (std::size_t k = 0; k < part.bins; ++k) {
      own.left.set(k, signal.left.at(begin + k));
      own.right.set(k, signal.right.at(begin + k));
    }
  }
  part.place_bins();
  part.place_lines();
  return part;
}

WhitenedRecord WhitenedRecord::noise(std::uint64_t seed) const {
  WhitenedRecord record = *this;
  record.draw_noise(seed);
  return record;
}

void WhitenedRecord::draw_noise(std::uint64_t seed) {
  const std::span<const double> draw = noise_draw(seed, 4 * bins);
  for (std::size_t k = 0; k < bins; ++k) {
    const Complex one = Complex(draw[4 * k], draw[4 * k + 1]) * std::numbers::sqrt2 * 0.5;
    const Complex other = Complex(draw[4 * k + 2], draw[4 * k + 3]) * std::numbers::sqrt2 * 0.5;
    const NoiseCovariance noise = noise_at(k);
    const double root = std::sqrt(noise.left);
    left.set(k, root * one);
    right.set(k, (noise.mixed * one + std::sqrt(noise.determinant()) * other) / root);
  }
}

}  // namespace modcal
