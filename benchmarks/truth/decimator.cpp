#include "benchmarks/truth/decimator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace modcal::truth {
namespace {

constexpr std::size_t kSecondFactor = 8;
constexpr std::size_t kFirstDelay = 5;  // (A − 8)/14.36 ≤ 2 · 5 · (1 − 2 kPass/8) taps
constexpr double kAttenuation = 130.0;  // of kRipple: 120 dB

/// I₀(x) by its power series.
double bessel_i0(double x) {
  double sum = 1.0, term = 1.0;
  for (int k = 1; term > 1e-18 * sum; ++k) {
    term *= 0.25 * x * x / (k * k);
    sum += term;
  }
  return sum;
}

}  // namespace

std::vector<double> kaiser_lowpass(std::size_t half, double cutoff, double attenuation) {
  const double beta = 0.1102 * (attenuation - 8.7);
  std::vector<double> taps(2 * half + 1);
  double sum = 0.0;
  for (std::size_t i = 0; i < taps.size(); ++i) {
    const double t = static_cast<double>(i) - static_cast<double>(half);
    const double part = t / static_cast<double>(half);
    const double phase = 2.0 * std::numbers::pi * cutoff * t;
    taps[i] =
        (t == 0.0 ? 1.0 : std::sin(phase) / phase) * bessel_i0(beta * std::sqrt(1.0 - part * part));
    sum += taps[i];
  }
  for (double& tap : taps) tap /= sum;
  return taps;
}

FirStage::FirStage(std::size_t factor, std::vector<double> taps)
    : factor_(factor),
      taps_(std::move(taps)),
      line_(std::max<std::size_t>(4096, 4 * taps_.size())) {}

std::optional<double> FirStage::push(double sample) {
  if (end_ == 0) {
    std::fill_n(line_.begin(), taps_.size() - 1, sample);
    end_ = taps_.size() - 1;
  }
  if (end_ == line_.size()) {
    std::copy(line_.end() - static_cast<std::ptrdiff_t>(taps_.size() - 1), line_.end(),
              line_.begin());
    end_ = taps_.size() - 1;
  }
  line_[end_++] = sample;
  if (waiting_-- > 0) return std::nullopt;
  waiting_ = factor_ - 1;
  const double* first = line_.data() + end_ - taps_.size();
  // Eight sums side by side: one would wait for itself.
  double sums[8] = {};
  std::size_t i = 0;
  for (; i + 8 <= taps_.size(); i += 8) {
    for (std::size_t s = 0; s < 8; ++s) sums[s] += taps_[i + s] * first[i + s];
  }
  for (; i < taps_.size(); ++i) sums[0] += taps_[i] * first[i];
  return ((sums[0] + sums[4]) + (sums[1] + sums[5])) + ((sums[2] + sums[6]) + (sums[3] + sums[7]));
}

Decimator::Decimator(std::size_t factor, bool filtered) : factor_(factor) {
  if (factor == 0 || factor % kSecondFactor != 0) {
    throw std::invalid_argument(
        fmt::format("decimation by {}: a multiple of {}", factor, kSecondFactor));
  }
  if (!filtered) return;
  // First stage: from kPass f_s to 8 f_s − kPass f_s, what would fold into the passband.
  const std::size_t first = factor / kSecondFactor;
  stages_.emplace_back(
      first, kaiser_lowpass(kFirstDelay * first, 0.5 / static_cast<double>(first), kAttenuation));
  // Second stage: from kPass to 1 − kPass, (A − 8)/(14.36 Δf) taps.
  const double transition = (1.0 - 2.0 * kPass) / kSecondFactor;
  const auto outputs = static_cast<std::size_t>(
      std::ceil((kAttenuation - 8.0) / (14.36 * transition) / (2.0 * kSecondFactor)));
  stages_.emplace_back(kSecondFactor,
                       kaiser_lowpass(kSecondFactor * outputs, 0.5 / kSecondFactor, kAttenuation));
  skip_ = 1 + outputs;
}

void Decimator::push(double sample) {
  if (stages_.empty()) {
    if (seen_++ % factor_ == 0) samples_.push_back(sample);
    return;
  }
  // Held before: together with the first stage's own delay one sample of the record.
  for (std::size_t i = kFirstDelay; !started_ && i < kSecondFactor; ++i)
    keep(stages_[1].push(sample));
  started_ = true;
  const std::optional<double> between = stages_[0].push(sample);
  if (between) keep(stages_[1].push(*between));
}

void Decimator::keep(const std::optional<double>& sample) {
  if (sample && seen_++ >= skip_) samples_.push_back(*sample);
}

std::size_t Decimator::latency() const { return skip_ * factor_; }

}  // namespace modcal::truth
