#include <array>

#include "libsim/dynamics/friction/coulomb_exponential.hpp"

namespace modcal {

Registry<FrictionLaw> FrictionLaw::registry() {
  static constexpr std::array kTable = {
      entry_of<FrictionLaw, CoulombExponential>(
          "coulomb_exponential", "Coulomb friction falling exponentially with the sliding speed"),
  };
  return kTable;
}

}  // namespace modcal
