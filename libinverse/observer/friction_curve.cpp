#include "libinverse/observer/friction_curve.hpp"

#include <algorithm>
#include <cmath>

#include "libsim/base/error.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal::observer {

std::vector<FrictionCell> friction_curve(std::span<const double> velocity,
                                         std::span<const double> force, double bow_velocity,
                                         std::size_t cells) {
  constexpr double kLeastSlip = 0.02;
  constexpr std::size_t kLeastSamples = 5;
  MODCAL_REQUIRE(
      velocity.size() == force.size() && !velocity.empty(),
      "{} velocities and {} forces: a friction curve needs as many of each, at least one",
      velocity.size(), force.size());
  MODCAL_REQUIRE(cells >= 1, "a friction curve needs at least one cell");
  MODCAL_REQUIRE(bow_velocity != 0.0 && std::isfinite(bow_velocity),
                 "bow velocity {:g} m/s: a resting bow has no direction", bow_velocity);
  const double direction = bow_velocity > 0.0 ? 1.0 : -1.0;
  double largest = 0.0;
  for (const double v : velocity) largest = std::max(largest, direction * (bow_velocity - v));
  std::vector<std::vector<double>> forces(cells);
  for (std::size_t k = 0; k < velocity.size() && largest > 0.0; ++k) {
    const double slip = direction * (bow_velocity - velocity[k]);
    if (slip < kLeastSlip * largest) continue;
    const auto cell = static_cast<std::size_t>(slip / largest * static_cast<double>(cells));
    forces[std::min(cell, cells - 1)].push_back(direction * force[k]);
  }
  std::vector<FrictionCell> curve;
  const double width = largest / static_cast<double>(cells);
  for (std::size_t i = 0; i < cells; ++i) {
    if (forces[i].size() < kLeastSamples) continue;
    curve.push_back({.speed = (static_cast<double>(i) + 0.5) * width,
                     .median = quantile(forces[i], 0.5),
                     .low = quantile(forces[i], 0.05),
                     .high = quantile(forces[i], 0.95),
                     .samples = forces[i].size()});
  }
  return curve;
}

}  // namespace modcal::observer
