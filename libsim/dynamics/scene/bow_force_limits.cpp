#include "libsim/dynamics/scene/bow_force_limits.hpp"

#include <cmath>
#include <numbers>
#include <variant>

#include "libsim/dynamics/scene/helmholtz_motion.hpp"

namespace modcal {
namespace {

// μ_S − μ at the slip speed.
double friction_fall(const FrictionLaw& law, double slip_speed) {
  const double sliding = std::visit(
      [slip_speed](const auto& unit) { return unit.at(slip_speed).force; }, law.sliding(1.0));
  return law.static_limit(1.0) - sliding;
}

// Σ ζ_n/n over the odd modes that Helmholtz motion needs: 1/β of them shape its slip.
double loss_sum(const ModalBasis& basis, double beta) {
  double sum = 0.0;
  for (std::size_t n = 1; n <= basis.size() && static_cast<double>(n) * beta <= 1.0; n += 2) {
    sum += basis.zeta[n - 1] / static_cast<double>(n);
  }
  return sum;
}

}  // namespace

BowForceLimits schelleng_limits(const Scene& scene) {
  const StringModel& string = scene.string;
  const double beta = relative_bow_position(scene.bow.position, string.length);
  const double speed = std::abs(scene.bow.velocity);
  const double impedance = std::sqrt(string.tension() * string.linear_density);
  const double fall = friction_fall(*scene.friction.make(), speed * (1.0 - beta) / beta);
  const double loss = loss_sum(make_modal_basis(string), beta);
  return {.lowest = 4.0 * impedance * speed * loss / (std::numbers::pi * beta * beta * fall),
          .highest = 2.0 * impedance * speed / (beta * fall)};
}

}  // namespace modcal
