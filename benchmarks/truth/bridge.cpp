#include "benchmarks/truth/bridge.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace modcal::truth {
namespace {

using std::numbers::pi;
using Complex = std::complex<double>;

}  // namespace

Bridge::Bridge(const TruthString& string, const TruthMismatch& mismatch, const WaveGrid& grid)
    : mass_(mismatch.bridge_mass),
      omega_(2.0 * pi * mismatch.body_frequency),
      damping_(mismatch.body_damping),
      length_(string.length),
      tension_(string.tension()),
      bending_(string.bending()),
      step_(grid.time_step),
      load_(grid.intervals + 1, 0.0) {
  const auto cells = static_cast<double>(grid.intervals);
  const double weight = string.linear_density * string.length / cells;
  for (std::size_t n = 1; n < grid.intervals; ++n) {
    const double part = (n % 2 == 1 ? 2.0 : -2.0) * weight / (pi * static_cast<double>(n));
    for (std::size_t j = 1; j < grid.intervals; ++j) {
      load_[j] += part * std::sin(pi * static_cast<double>((n * j) % (2 * grid.intervals)) / cells);
    }
  }
}

double Bridge::acceleration(double support_force) const {
  const double rate = change_ / step_;
  return (-support_force - tension_ * u_ / length_) / mass_ - 2.0 * damping_ * omega_ * rate -
         omega_ * omega_ * u_;
}

void Bridge::advance(double acceleration) {
  last_change_ = change_;
  change_ += step_ * step_ * acceleration;
  u_ += change_;
}

double Bridge::support_gain(std::size_t n) const {
  const double wavenumber = pi * static_cast<double>(n) / length_;
  return tension_ + bending_ * wavenumber * wavenumber;
}

std::vector<WaveMode> Bridge::coupled(const std::vector<WaveMode>& pinned) const {
  constexpr int kRounds = 200;
  std::vector<WaveMode> modes;
  for (std::size_t n = 0; n < pinned.size(); ++n) {
    const double omega = pinned[n].omega, sigma = pinned[n].decay;
    const Complex own(-sigma, std::sqrt(omega * omega - sigma * sigma));
    Complex s = own, last = 0.0;
    int round = 0;
    for (; round < kRounds && std::abs(s - last) > 1e-13 * omega; ++round) {
      Complex others = mass_ * (s * s + 2.0 * damping_ * omega_ * s + omega_ * omega_);
      others += tension_ / length_;
      for (std::size_t i = 0; i < pinned.size(); ++i) {
        const WaveMode& mode = pinned[i];
        if (i == n) continue;
        others += 2.0 / length_ * s * s * support_gain(i + 1) /
                  (mode.omega * mode.omega + 2.0 * mode.decay * s + s * s);
      }
      last = s;
      s = own - 2.0 / length_ * s * s * support_gain(n + 1) / (others * (s - std::conj(own)));
    }
    if (round == kRounds) {
      throw std::invalid_argument(
          fmt::format("mode {} of the string and the bridge's at {:g} Hz are too near to be told "
                      "apart: take a heavier bridge or another frequency",
                      n + 1, omega_ / (2.0 * pi)));
    }
    modes.push_back({.omega = std::abs(s), .decay = -s.real()});
  }
  return modes;
}

}  // namespace modcal::truth
