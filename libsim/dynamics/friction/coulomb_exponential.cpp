#include "libsim/dynamics/friction/coulomb_exponential.hpp"

#include "libsim/base/error.hpp"

namespace modcal {

void CoulombExponential::Options::visit(OptionVisitor& visitor) {
  visitor.number({.key = "static",
                  .meaning = "static friction coefficient mu_S",
                  .unit = "1",
                  .range = Range::non_negative()},
                 static_coefficient);
  visitor.number({.key = "dynamic",
                  .meaning = "dynamic friction coefficient mu_D at high speed, at most mu_S",
                  .unit = "1",
                  .range = Range::non_negative()},
                 dynamic_coefficient);
  visitor.number({.key = "decay",
                  .meaning = "decay C of the friction coefficient with the sliding speed",
                  .unit = "s/m",
                  .range = Range::non_negative()},
                 decay);
  visitor.section({.key = "adherence", .meaning = "spring and damper while sticking"}, adherence);
}

CoulombExponential::CoulombExponential(const Options& options) : options_(options) {
  MODCAL_REQUIRE(options.dynamic_coefficient <= options.static_coefficient,
                 "dynamic friction coefficient {:g} is above the static one, {:g}: the law must "
                 "fall with the sliding speed",
                 options.dynamic_coefficient, options.static_coefficient);
}

SlidingLaw CoulombExponential::make_sliding(double normal_force) const {
  const double drop = options_.static_coefficient - options_.dynamic_coefficient;
  return ExponentialSliding{.dynamic_force = options_.dynamic_coefficient * normal_force,
                            .force_drop = drop * normal_force,
                            .decay = options_.decay};
}

}  // namespace modcal
