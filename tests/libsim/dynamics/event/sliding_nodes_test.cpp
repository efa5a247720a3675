// The nodes of a sliding step, also where a trial step ends behind a switch.
#include <gtest/gtest.h>

#include <cmath>

#include "libsim/dynamics/event/sliding/contact_friction.hpp"

namespace modcal::event::sliding_nodes_test {
namespace {

const ExponentialSliding kLaw{.dynamic_force = 0.2, .force_drop = 0.2, .decay = 5.0};

// Below 0 the law goes on by its parabola as far as its slope doubles, by the tangent beyond:
// g = 0.4 − u + 2.5 u² down to −0.2, where it is 0.7 with the slope −2.
double continued(double u) {
  if (u >= 0.0) return 0.2 + 0.2 * std::exp(-5.0 * u);
  return u > -0.2 ? 0.4 - u + 2.5 * u * u : 0.7 - 2.0 * (u + 0.2);
}
double slope_continued(double u) {
  if (u >= 0.0) return -std::exp(-5.0 * u);
  return u > -0.2 ? -1.0 + 5.0 * u : -2.0;
}

TEST(SolveNodes, SolvesTheLawAndWhatContinuesIt) {
  for (const int nodes : {2, 3, 4, 5}) {
    NodeMatrix coupling{};
    NodeVector free{};
    NodeValues values;
    values.friction[0] = 0.35;
    // Speeds that the equations are made for: sliding, behind the switch, far behind it.
    const double speeds[] = {0.1, 0.3, -0.1, -0.45, 0.02};
    for (int i = 0; i < nodes; ++i) {
      values.load[i] = 1.0 + 0.1 * i;
      for (int j = 0; j < nodes; ++j) coupling[i][j] = 0.02 + 0.01 * (i == j) + 0.003 * (i - j);
    }
    for (int shift = 0; shift < 4; ++shift) {
      const auto speed = [&](int i) { return speeds[1 + (i - 1 + shift) % 4]; };
      for (int i = 1; i < nodes; ++i) {
        free[i] = speed(i) + coupling[i][0] * values.friction[0];
        for (int j = 1; j < nodes; ++j) {
          free[i] += coupling[i][j] * values.load[j] * continued(speed(j));
        }
        values.speed[i] = speed(i) + 0.01;
      }
      ASSERT_TRUE(solve_nodes(kLaw, nodes, coupling, free, values)) << nodes;
      for (int i = 1; i < nodes; ++i) {
        // Rounding of numbers below 1, a few terms each.
        EXPECT_NEAR(values.speed[i], speed(i), 1e-14) << nodes << ", " << i;
        EXPECT_NEAR(values.friction[i], values.load[i] * continued(speed(i)), 1e-13);
        EXPECT_NEAR(values.slope[i], values.load[i] * slope_continued(speed(i)), 1e-7);
      }
    }
  }
}

}  // namespace
}  // namespace modcal::event::sliding_nodes_test
