#include "libsim/dynamics/fixed_step/explicit_stability.hpp"

#include <cmath>

#include "libsim/base/error.hpp"

namespace modcal {

void require_stable_contact(const ExplicitContact& contact, double time_step) {
  const double c = contact.response * contact.damping;
  const double k = 0.5 * contact.response * contact.stiffness * time_step;
  MODCAL_REQUIRE(std::abs(k - c) < 1.0 && c * (1.0 - c) > k * (2.0 - c),
                 "time step {:g} s is too long for an explicit scheme with adherence of {:g} N/m "
                 "and {:g} N s/m: the contact would create energy; take a shorter step, a softer "
                 "or nearly critically damped adherence, or modal_exact or modal_event",
                 time_step, contact.stiffness, contact.damping);
  const double slope_number = contact.fall * contact.response;
  MODCAL_REQUIRE(slope_number < 0.5,
                 "time step {:g} s is too long for an explicit scheme with this friction law: its "
                 "force falls by {:g} N per m/s, which needs a step below about {:g} s",
                 time_step, contact.fall, 0.5 * time_step / slope_number);
}

}  // namespace modcal
