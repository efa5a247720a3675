#include "libsim/dynamics/simulators/explicit_stability.hpp"

#include <cmath>

#include "libsim/base/error.hpp"

namespace modcal {

void require_stable_contact(const ContactParameters& contact, const SlidingLaw& law,
                            double response, double time_step) {
  if (!(contact.static_limit > 0.0)) return;  // no force, no contact
  const double c = response * contact.damping;
  const double k = 0.5 * response * contact.stiffness * time_step;
  MODCAL_REQUIRE(std::abs(k - c) < 1.0 && c * (1.0 - c) > k * (2.0 - c),
                 "time step {:g} s is too long for an explicit scheme with adherence of {:g} N/m "
                 "and {:g} N s/m: the contact would create energy; take a shorter step, a softer "
                 "or nearly critically damped adherence, or modal_exact or modal_event",
                 time_step, contact.stiffness, contact.damping);
  const double fall = std::visit([](const auto& l) { return l.steepest_fall(); }, law);
  MODCAL_REQUIRE(fall * response < 0.5,
                 "time step {:g} s is too long for an explicit scheme with this friction law: its "
                 "force falls by {:g} N per m/s, which needs a step below about {:g} s",
                 time_step, fall, 0.5 * time_step / (fall * response));
}

}  // namespace modcal
