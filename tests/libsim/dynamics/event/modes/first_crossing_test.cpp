#include "libsim/dynamics/event/modes/first_crossing.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace modcal::event::first_crossing_test {
namespace {

// Coefficients of Π (θ − root)·scale.
std::vector<double> product(double scale, std::initializer_list<double> roots) {
  std::vector<double> c{scale};
  for (const double root : roots) {
    c.insert(c.begin(), 0.0);
    for (std::size_t i = 0; i + 1 < c.size(); ++i) c[i] -= root * c[i + 1];
  }
  return c;
}

TEST(FirstCrossing, FindsTheFirstOfSeveralRoots) {
  // p(0) > 0: roots 0.3 < 0.31 < 0.9. Condition of the root: rounding of p over |p'| = 0.006.
  const auto c = product(-1.0, {0.3, 0.31, 0.9});
  const auto found = first_crossing(c, 1.0, false);
  ASSERT_TRUE(found);
  EXPECT_NEAR(*found, 0.3, 4 * 2.3e-16 / 0.006);
}

TEST(FirstCrossing, SeesAPairOfRootsBetweenPositiveEnds) {
  const auto c = product(1.0, {0.5 - 1e-5, 0.5 + 1e-5});
  const auto found = first_crossing(c, 1.0, false);
  ASSERT_TRUE(found);
  EXPECT_NEAR(*found, 0.5 - 1e-5, 2.3e-16 / 2e-5 * 4);
}

TEST(FirstCrossing, PassesAMinimumThatStaysPositive) {
  auto c = product(1.0, {0.5, 0.5});
  c[0] += 1e-12;
  EXPECT_FALSE(first_crossing(c, 1.0, false));
}

TEST(FirstCrossing, TakesAGrazingContactForOne) {
  const auto found = first_crossing(product(1.0, {0.5, 0.5}), 1.0, false);
  ASSERT_TRUE(found);
  EXPECT_NEAR(*found, 0.5, 1e-6);  // where p reaches its rounding, √(eps)
}

TEST(FirstCrossing, DoesNotCountAKnownZeroAtTheStart) {
  const auto found = first_crossing(product(-1.0, {0.0, 0.4}), 1.0, true);
  ASSERT_TRUE(found);
  EXPECT_NEAR(*found, 0.4, 1e-15);
  EXPECT_FALSE(first_crossing(product(1.0, {0.0, 0.0, -1.0}), 1.0, true));  // rises like θ²
  EXPECT_EQ(first_crossing(product(1.0, {0.0, 0.4}), 1.0, true), 0.0);      // falls at once
}

TEST(FirstCrossing, LooksNoFurtherThanAsked) {
  const auto c = product(-1.0, {0.7});
  EXPECT_FALSE(first_crossing(c, 0.6, false));
  EXPECT_TRUE(first_crossing(c, 0.8, false));
}

}  // namespace
}  // namespace modcal::event::first_crossing_test
