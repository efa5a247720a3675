#include "libinverse/modes/decay_record.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"

namespace modcal {

void DecayRecord::require_valid() const {
  MODCAL_REQUIRE(sample_rate > 0.0 && std::isfinite(sample_rate),
                 "sample rate {:g} Hz of a decay must be > 0", sample_rate);
  MODCAL_REQUIRE(samples() > 0, "a decay without samples: give at least one channel");
  for (const auto& channel : channels) {
    MODCAL_REQUIRE(channel.size() == samples(),
                   "channels of a decay must have one length: {} and {} samples are given",
                   samples(), channel.size());
    MODCAL_REQUIRE(std::all_of(channel.begin(), channel.end(),
                               [](double value) { return std::isfinite(value); }),
                   "a sample of the decay is not a finite number");
  }
}

DecayPole DecayPole::of_exponent(std::complex<double> exponent) {
  const double omega = std::abs(exponent);
  return {omega / (2.0 * std::numbers::pi), omega > 0.0 ? -exponent.real() / omega : 0.0};
}

std::complex<double> DecayPole::exponent() const {
  const double omega = 2.0 * std::numbers::pi * frequency;
  return {-damping_ratio * omega, omega * std::sqrt(1.0 - damping_ratio * damping_ratio)};
}

}  // namespace modcal
