#include "libsim/dynamics/friction/friction_law.hpp"

#include "libsim/base/error.hpp"

namespace modcal {

void Adherence::visit(OptionVisitor& visitor) {
  visitor.number({.key = "stiffness",
                  .meaning = "adherence stiffness K_a",
                  .unit = "N/m",
                  .range = Range::positive()},
                 stiffness);
  visitor.number({.key = "damping",
                  .meaning = "adherence damping C_a; near_critical: 2 sqrt(K_a m_eff)",
                  .unit = "N s/m",
                  .range = Range::non_negative(),
                  .word = "near_critical"},
                 damping);
}

SlidingLaw FrictionLaw::sliding(double normal_force) const {
  MODCAL_REQUIRE(normal_force >= 0.0, "normal force {:g} N must be >= 0", normal_force);
  return make_sliding(normal_force);
}

SlidingLaw FrictionLaw::make_sliding(double /*normal_force*/) const {
  throw_invalid_input(
      "this friction law has a state (temperature, deflection): it is no curve over the sliding "
      "speed; use a law of the sliding speed alone");
}

double FrictionLaw::static_limit(double normal_force) const {
  MODCAL_REQUIRE(normal_force >= 0.0, "normal force {:g} N must be >= 0", normal_force);
  return static_coefficient() * normal_force;
}

}  // namespace modcal
