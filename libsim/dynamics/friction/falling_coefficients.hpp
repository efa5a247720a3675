// Static and dynamic coefficient of friction laws that fall with the sliding speed.
#pragma once

#include "libsim/base/options.hpp"

namespace modcal {

/// Visits μ_S and μ_D [1] as "static" and "dynamic".
void visit_falling_coefficients(OptionVisitor& visitor, double& static_coefficient,
                                double& dynamic_coefficient);

/// Throws InvalidInput unless μ_D ≤ μ_S.
void require_falling(double static_coefficient, double dynamic_coefficient);

}  // namespace modcal
