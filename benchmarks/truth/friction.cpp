#include "benchmarks/truth/friction.hpp"

#include <cmath>
#include <stdexcept>

namespace modcal::truth {
namespace {

void check(const ExponentialFriction& law) {
  if (!(law.dynamic_coefficient >= 0.0) || !(law.static_coefficient >= law.dynamic_coefficient) ||
      !(law.decay >= 0.0)) {
    throw std::invalid_argument("friction: 0 <= dynamic <= static coefficient and decay >= 0");
  }
}

void check(const ThermalFriction& law) {
  if (!(law.hot_coefficient >= 0.0) || !(law.cold_coefficient >= law.hot_coefficient) ||
      !(law.softening_width > 0.0) || !(law.heat_capacity > 0.0)) {
    throw std::invalid_argument(
        "friction: 0 <= hot <= cold coefficient, softening width > 0 and heat capacity > 0");
  }
}

double coefficient(const ExponentialFriction& law, double speed, double /*temperature*/) {
  return law.dynamic_coefficient +
         (law.static_coefficient - law.dynamic_coefficient) * std::exp(-law.decay * speed);
}

double coefficient(const ThermalFriction& law, double /*speed*/, double temperature) {
  const double softened = std::exp((temperature - law.softening_rise) / law.softening_width);
  return law.hot_coefficient + (law.cold_coefficient - law.hot_coefficient) / (1.0 + softened);
}

double heated(const ExponentialFriction& /*law*/, const ContactState& /*state*/,
              double /*temperature*/, double /*time_step*/) {
  return 0.0;
}

double heated(const ThermalFriction& law, const ContactState& state, double temperature,
              double time_step) {
  const double power = std::abs(state.force * state.slip);
  const double leaving = law.conductance + law.carried_heat * std::abs(state.slip);
  return (temperature + time_step * power / law.heat_capacity) /
         (1.0 + time_step * leaving / law.heat_capacity);
}

}  // namespace

Contact::Contact(const Friction& friction, double time_step)
    : friction_(friction), time_step_(time_step) {
  std::visit([](const auto& law) { check(law); }, friction_);
}

double Contact::last_coefficient(double speed) const {
  return std::visit([&](const auto& law) { return coefficient(law, speed, last_temperature_); },
                    friction_);
}

ContactState Contact::solve(const ContactLoad& load) {
  last_temperature_ = temperature_;
  const double relative = load.free_velocity - load.bow_velocity;
  ContactState state{.force = -relative / load.mobility, .slip = 0.0, .stuck = true};
  if (std::abs(state.force) > load.normal_force * last_coefficient(0.0)) {
    state = slide(load, relative);
  }
  temperature_ =
      std::visit([&](const auto& law) { return heated(law, state, last_temperature_, time_step_); },
                 friction_);
  return state;
}

ContactState Contact::slide(const ContactLoad& load, double relative) const {
  const double strength = load.mobility * load.normal_force;
  double drop = 0.0, decay = 0.0;
  if (const auto* law = std::get_if<ExponentialFriction>(&friction_)) {
    drop = law->static_coefficient - law->dynamic_coefficient;
    decay = law->decay;
  }
  if (strength * drop * decay >= 1.0) {
    throw std::invalid_argument(
        "the friction curve is steeper than the load line of a time step: raise the internal rate");
  }
  // u + Y N μ(u) − |r₀| is convex and grows: from the right Newton's steps approach its root from
  // one side, until rounding turns them.
  const double target = std::abs(relative);
  double speed = target;
  for (int i = 0; i < 60; ++i) {
    const double slope = 1.0 - strength * drop * decay * std::exp(-decay * speed);
    const double moved = (speed + strength * last_coefficient(speed) - target) / slope;
    speed -= moved;
    if (!(moved > 1e-15 * target)) break;
  }
  const double side = relative < 0.0 ? -1.0 : 1.0;
  return {.force = -side * load.normal_force * last_coefficient(speed), .slip = side * speed};
}

}  // namespace modcal::truth
