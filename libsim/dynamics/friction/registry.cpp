#include <array>

#include "libsim/dynamics/friction/coulomb_exponential.hpp"
#include "libsim/dynamics/friction/hyperbolic.hpp"

namespace modcal {

Registry<FrictionLaw> FrictionLaw::registry() {
  static constexpr std::array kTable = {
      entry_of<FrictionLaw, CoulombExponential>(
          "coulomb_exponential", "Coulomb friction falling exponentially with the sliding speed"),
      entry_of<FrictionLaw, Hyperbolic>(
          "hyperbolic", "Coulomb friction falling as a hyperbola of the sliding speed"),
  };
  return kTable;
}

}  // namespace modcal
