// What the continuum's string does, in closed form.
#pragma once

#include <cmath>
#include <numbers>

#include "benchmarks/truth/truth.hpp"

namespace modcal::truth {

constexpr double kPi = std::numbers::pi;

inline double frequency(const TruthString& string, std::size_t n) {
  const double order = static_cast<double>(n);
  return order * string.fundamental * std::sqrt(1.0 + string.inharmonicity * order * order);
}

inline double decay(const TruthString& string, std::size_t n) {
  const double wavenumber = static_cast<double>(n) * kPi / string.length;
  return string.loss + string.diffusion * wavenumber * wavenumber;
}

inline WaveEquation equation_of(const TruthString& string) {
  return {.length = string.length,
          .density = string.linear_density,
          .speed = string.wave_speed(),
          .stiffness = std::sqrt(string.bending() / string.linear_density),
          .loss = string.loss,
          .diffusion = string.diffusion};
}

}  // namespace modcal::truth
