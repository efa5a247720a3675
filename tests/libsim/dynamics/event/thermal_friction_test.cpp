// One step of a contact that heats up.
#include <gtest/gtest.h>

#include <cmath>

#include "libsim/dynamics/event/sliding/contact_friction.hpp"

namespace modcal::event::thermal_friction_test {
namespace {

// Far above where the rosin softens the coefficient is the hot one, the speeds are given, and
// H ϑ' = l μ u − (G + S u) ϑ of a steady speed is an exponential. Its width, a millionth of a
// kelvin, is below the rounding of the temperature and no measure of its error.
TEST(ThermalFriction, OfAHotContactIsSolvedToRounding) {
  for (const int nodes : {2, 3, 4, 5}) {
    for (const double rise : {300.0, 317.3, 411.7}) {
      const ThermalSliding law{.hot = 0.2,
                               .drop = 0.2,
                               .softening = 100.0,
                               .softening_width = 1e-6,
                               .capacity = 1e-3,
                               .conductance = 2e-3,
                               .carried = 1e-3,
                               .rise = rise};
      const LobattoRule rule = lobatto_rule(nodes);
      ThermalFriction friction(law, rule, 1e-3);
      NodeMatrix coupling{};
      NodeVector free{};
      NodeValues values;
      for (int i = 0; i < nodes; ++i) {
        values.load[i] = 1.5;
        values.speed[i] = free[i] = 0.7;
      }
      values.friction[0] = 0.3;
      constexpr double kStep = 1e-4;
      ASSERT_TRUE(friction.solve(coupling, free, kStep, values)) << nodes << ", " << rise;
      friction.accept(1.0);
      const double rate = (2e-3 + 1e-3 * 0.7) / 1e-3, steady = 0.3 * 0.7 / 2.7e-3;
      const double expected = steady + (rise - steady) * std::exp(-rate * kStep);
      // Of order 2 s − 2, the trapezoidal rule (rate·h)³/12 = 1.6e-12 of it.
      EXPECT_NEAR(friction.rise() / expected, 1.0, 1e-11) << nodes << ", " << rise;
      for (int i = 1; i < nodes; ++i) EXPECT_DOUBLE_EQ(values.friction[i], 0.3);
    }
  }
}

// ϑ' = g ϑ of a contact at rest whose loss is negative: one step of the collocation multiplies by
// the stability function of Lobatto IIIA, a Padé approximation of e^z, z = g h.
double grown(int nodes, double z, double rise) {
  const ThermalSliding law{.hot = 0.2, .drop = 0.2, .conductance = -1.0, .rise = rise};
  ThermalFriction friction(law, lobatto_rule(nodes), 1e-3);
  NodeValues values;
  for (int i = 0; i < nodes; ++i) values.load[i] = 1.0;
  if (!friction.solve({}, {}, z, values)) return -1.0;
  friction.accept(1.0);
  return friction.rise();
}

// 1 − z/3, the first pivot of three nodes, is 0: (1 + z/2 + z²/12)/(1 − z/2 + z²/12) = 13.
TEST(ThermalFriction, IsSolvedWhereAPivotIsZero) { EXPECT_NEAR(grown(3, 3.0, 1.0), 13.0, 1e-12); }

// The denominator of four nodes has a root at z = 4.644; beside it the equations are
// ill-conditioned, and no correction need be smaller than what rounding leaves of them.
TEST(ThermalFriction, IsSolvedAsFarAsItsConditionAllows) {
  for (const double z : {4.6, 4.63, 4.64}) {
    const double even = 1.0 + z * z / 10.0, odd = z / 2.0 + z * z * z / 120.0;
    const double growth = (even + odd) / (even - odd);
    for (int i = 0; i < 34; ++i) {
      const double rise = 1.0 + 0.237 * i;
      // Rounding of the equations times their condition, about the growth's size.
      EXPECT_NEAR(grown(4, z, rise) / (growth * rise), 1.0, 1e-14 * growth) << z << ", " << rise;
    }
  }
}

}  // namespace
}  // namespace modcal::event::thermal_friction_test
