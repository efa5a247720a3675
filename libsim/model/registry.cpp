#include <array>

#include "libsim/model/constant_damping.hpp"
#include "libsim/model/measured_damping.hpp"
#include "libsim/model/polynomial_damping.hpp"

namespace modcal {

Registry<DampingLaw> DampingLaw::registry() {
  static constexpr std::array kTable = {
      entry_of<DampingLaw, ConstantDamping>("constant", "one damping ratio for all modes"),
      entry_of<DampingLaw, MeasuredDamping>(
          "measured", "ratios of some modes, extrapolated by a polynomial of the mode number"),
      entry_of<DampingLaw, PolynomialDamping>("polynomial",
                                              "damping ratio as a polynomial of the mode number"),
  };
  return kTable;
}

}  // namespace modcal
