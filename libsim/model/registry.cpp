#include <array>

#include "libsim/model/constant_damping.hpp"
#include "libsim/model/measured_damping.hpp"
#include "libsim/model/polynomial_damping.hpp"
#include "libsim/model/table_damping.hpp"
#include "libsim/model/valette_cuesta_damping.hpp"
#include "libsim/model/woodhouse_damping.hpp"

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
