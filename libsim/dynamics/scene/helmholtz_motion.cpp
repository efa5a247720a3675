#include "libsim/dynamics/scene/helmholtz_motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"
#include "libsim/dynamics/scene/contact_modes.hpp"

namespace modcal {

double relative_bow_position(double contact, double length) {
  MODCAL_REQUIRE(contact > 0.0 && contact < length,
                 "bow position {:g} m is not inside the string: it must lie in (0, {:g}) m",
                 contact, length);
  return std::min(contact, length - contact) / length;
}

double helmholtz_velocity_rms(double relative_position, double bow_velocity) {
  return std::abs(bow_velocity) * std::sqrt((1.0 - relative_position) / relative_position);
}

ModalState helmholtz_motion(const ModalBasis& basis, double contact, double bow_velocity) {
  const double beta = relative_bow_position(contact, basis.length);
  const bool near_left = contact <= 0.5 * basis.length;
  const std::vector<double> shape = basis.shape_at(contact);
  ModalState state{std::vector<double>(basis.size()), std::vector<double>(basis.size())};
  for (std::size_t n = 1; n <= basis.size(); ++n) {
    if (is_node(shape[n - 1])) continue;
    const double sign = near_left && n % 2 == 0 ? -1.0 : 1.0;
    state.velocity[n - 1] =
        sign * 2.0 * bow_velocity / (beta * static_cast<double>(n) * std::numbers::pi);
  }
  return state;
}

}  // namespace modcal
