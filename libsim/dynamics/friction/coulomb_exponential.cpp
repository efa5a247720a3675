#include "libsim/dynamics/friction/coulomb_exponential.hpp"

#include "libsim/dynamics/friction/falling_coefficients.hpp"

namespace modcal {

void CoulombExponential::Options::visit(OptionVisitor& visitor) {
  visit_falling_coefficients(visitor, static_coefficient, dynamic_coefficient);
  visitor.number({.key = "decay",
                  .meaning = "decay C of the friction coefficient with the sliding speed",
                  .unit = "s/m",
                  .range = Range::non_negative()},
                 decay);
  visitor.section({.key = "adherence", .meaning = "spring and damper while sticking"}, adherence);
}

CoulombExponential::CoulombExponential(const Options& options) : options_(options) {
  require_falling(options.static_coefficient, options.dynamic_coefficient);
}

SlidingLaw CoulombExponential::make_sliding(double normal_force) const {
  const double drop = options_.static_coefficient - options_.dynamic_coefficient;
  return ExponentialSliding{.dynamic_force = options_.dynamic_coefficient * normal_force,
                            .force_drop = drop * normal_force,
                            .decay = options_.decay};
}

}  // namespace modcal
