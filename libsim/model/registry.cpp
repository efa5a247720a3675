#include <array>

#include "libsim/model/damping_laws.hpp"

namespace modcal {

Registry<DampingLaw> DampingLaw::registry() {
  static constexpr std::array kTable = {
      entry_of<DampingLaw, ConstantDamping>("constant", "one damping ratio for all modes"),
      entry_of<DampingLaw, MeasuredDamping>(
          "measured", "ratios of some modes, extrapolated by a polynomial of the mode number"),
      entry_of<DampingLaw, PolynomialDamping>("polynomial",
                                              "damping ratio as a polynomial of the mode number"),
      entry_of<DampingLaw, TableDamping>("table", "damping ratio against frequency"),
      entry_of<DampingLaw, ValetteCuestaDamping>(
          "valette_cuesta", "losses of a metal string: air, viscoelasticity, dislocations"),
      entry_of<DampingLaw, WoodhouseDamping>("woodhouse",
                                             "losses by friction, air and bending of a string"),
  };
  return kTable;
}

}  // namespace modcal
