#include "libsim/model/damping.hpp"

#include "libsim/base/error.hpp"

namespace modcal {

std::vector<double> DampingLaw::ratios(std::span<const double> omega,
                                       const StringConstants& string) const {
  std::vector<double> zeta(omega.size());
  for (std::size_t i = 0; i < omega.size(); ++i) {
    zeta[i] = ratio({i, omega[i], string});
    MODCAL_REQUIRE(zeta[i] >= 0.0 && zeta[i] < 1.0,
                   "damping ratio {:g} of mode {} is outside [0, 1): the model needs oscillating "
                   "modes",
                   zeta[i], i + 1);
  }
  return zeta;
}

}  // namespace modcal
