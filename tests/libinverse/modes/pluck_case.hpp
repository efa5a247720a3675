// Free decays with known modes.
#pragma once

#include <cmath>
#include <complex>
#include <string_view>
#include <vector>

#include "libinverse/modes/decay_record.hpp"
#include "libsim/base/random.hpp"

namespace modcal {

/// y_c(t) = Σ_k Re(A_ck exp(λ_k t)), exact.
inline DecayRecord decay_of(const std::vector<DecayMode>& modes, std::size_t channels,
                            double sample_rate, std::size_t samples) {
  DecayRecord record{.sample_rate = sample_rate};
  for (std::size_t c = 0; c < channels; ++c) {
    std::vector<double> channel(samples, 0.0);
    for (const DecayMode& mode : modes) {
      for (std::size_t m = 0; m < samples; ++m) {
        const double t = static_cast<double>(m) / sample_rate;
        channel[m] += (mode.amplitude[c] * std::exp(mode.pole.exponent() * t)).real();
      }
    }
    record.channels.push_back(std::move(channel));
  }
  return record;
}

/// Reactions at both ends of a string plucked at a fraction of its length and let go at t = 0:
/// q_n ∝ sin(nπξ)/n² for a triangle, R_1 ∝ −n q_n, R_2 ∝ (−1)ⁿ n q_n (closed form).
inline std::vector<DecayMode> plucked_modes(std::size_t count, double fundamental,
                                            double inharmonicity, double place) {
  std::vector<DecayMode> modes;
  for (std::size_t n = 1; n <= count; ++n) {
    const auto number = static_cast<double>(n);
    const double stretch = std::sqrt(1.0 + inharmonicity * number * number);
    const double shape = std::sin(number * M_PI * place) / number;
    // Released from rest: q̇(0) = 0 gives A the phase of 1 + iζ/√(1 − ζ²).
    const DecayPole pole{number * fundamental * stretch, 2e-4 + 4e-5 * number};
    const std::complex<double> released(
        1.0, pole.damping_ratio / -std::sqrt(1.0 - std::pow(pole.damping_ratio, 2)));
    modes.push_back(
        {.pole = pole, .amplitude = {-shape * released, (n % 2 ? -shape : shape) * released}});
  }
  return modes;
}

inline void add_noise(DecayRecord& record, double deviation, std::uint64_t seed) {
  for (std::size_t c = 0; c < record.channels.size(); ++c) {
    std::vector<double> noise(record.samples());
    fill_standard_normal(StreamKey(seed).with("decay").with(std::uint64_t{c}), noise);
    for (std::size_t m = 0; m < noise.size(); ++m) record.channels[c][m] += deviation * noise[m];
  }
}

}  // namespace modcal
