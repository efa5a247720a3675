#include <array>

#include "libsim/dynamics/friction/coulomb_exponential.hpp"
#include "libsim/dynamics/friction/elasto_plastic.hpp"
#include "libsim/dynamics/friction/hyperbolic.hpp"
#include "libsim/dynamics/friction/thermal.hpp"

namespace modcal {

Registry<FrictionLaw> FrictionLaw::registry() {
  static constexpr std::array kTable = {
      entry_of<FrictionLaw, CoulombExponential>(
          "coulomb_exponential", "Coulomb friction falling exponentially with the sliding speed"),
      entry_of<FrictionLaw, ElastoPlastic>(
          "elasto_plastic", "bristles that deflect before they slide, LuGre as a case"),
      entry_of<FrictionLaw, Hyperbolic>(
          "hyperbolic", "Coulomb friction falling as a hyperbola of the sliding speed"),
      entry_of<FrictionLaw, Thermal>("thermal",
                                     "rosin that softens with the temperature of the contact"),
  };
  return kTable;
}

}  // namespace modcal
