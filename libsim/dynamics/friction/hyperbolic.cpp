#include "libsim/dynamics/friction/hyperbolic.hpp"

#include "libsim/base/error.hpp"
#include "libsim/dynamics/friction/falling_coefficients.hpp"

namespace modcal {

void Hyperbolic::Options::visit(OptionVisitor& visitor) {
  visit_falling_coefficients(visitor, static_coefficient, dynamic_coefficient);
  visitor.number({.key = "half_speed",
                  .meaning = "sliding speed v0 at which half of the fall has happened",
                  .unit = "m/s",
                  .range = Range::positive()},
                 half_speed);
  visitor.section({.key = "adherence", .meaning = "spring and damper while sticking"}, adherence);
}

Hyperbolic::Hyperbolic(const Options& options) : options_(options) {
  require_falling(options.static_coefficient, options.dynamic_coefficient);
  MODCAL_REQUIRE(options.half_speed > 0.0, "half speed {:g} m/s must be > 0", options.half_speed);
}

SlidingLaw Hyperbolic::make_sliding(double normal_force) const {
  const double drop = options_.static_coefficient - options_.dynamic_coefficient;
  return HyperbolicSliding{.dynamic_force = options_.dynamic_coefficient * normal_force,
                           .force_drop = drop * normal_force,
                           .half_speed = options_.half_speed};
}

}  // namespace modcal
