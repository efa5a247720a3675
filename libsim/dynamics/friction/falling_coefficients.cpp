#include "libsim/dynamics/friction/falling_coefficients.hpp"

#include "libsim/base/error.hpp"

namespace modcal {

void visit_falling_coefficients(OptionVisitor& visitor, double& static_coefficient,
                                double& dynamic_coefficient) {
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
}

void require_falling(double static_coefficient, double dynamic_coefficient) {
  MODCAL_REQUIRE(dynamic_coefficient <= static_coefficient,
                 "dynamic friction coefficient {:g} is above the static one, {:g}: the law must "
                 "fall with the sliding speed",
                 dynamic_coefficient, static_coefficient);
}

}  // namespace modcal
