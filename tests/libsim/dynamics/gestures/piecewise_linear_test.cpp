#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "libsim/base/error.hpp"
#include "libsim/dynamics/gestures/gesture.hpp"

namespace modcal::piecewise_linear_test {
namespace {

const PiecewiseLinear kTrapezoid({0.5, 1.0, 2.0, 2.25}, {0.0, 2.0, 2.0, -1.0});

TEST(PiecewiseLinear, IsLinearBetweenItsKnotsAndConstantOutside) {
  EXPECT_EQ(kTrapezoid.at(-1.0), 0.0);
  EXPECT_EQ(kTrapezoid.at(0.5), 0.0);
  EXPECT_EQ(kTrapezoid.at(0.75), 1.0);
  EXPECT_EQ(kTrapezoid.at(1.5), 2.0);
  EXPECT_EQ(kTrapezoid.at(2.125), 0.5);
  EXPECT_EQ(kTrapezoid.at(9.0), -1.0);
  EXPECT_EQ(kTrapezoid.slope(0.0), 0.0);
  EXPECT_EQ(kTrapezoid.slope(0.5), 4.0);  // the derivative to the right
  EXPECT_EQ(kTrapezoid.slope(2.0), -12.0);
  EXPECT_EQ(kTrapezoid.slope(2.25), 0.0);
}

TEST(PiecewiseLinear, ListsItsKnots) {
  EXPECT_EQ(kTrapezoid.next_knot(0.0), 0.5);
  EXPECT_EQ(kTrapezoid.next_knot(0.5), 1.0);
  EXPECT_EQ(kTrapezoid.next_knot(2.25), std::numeric_limits<double>::infinity());
  EXPECT_EQ(PiecewiseLinear(3.0).next_knot(0.0), std::numeric_limits<double>::infinity());
}

TEST(PiecewiseLinear, IntegratesFromZero) {
  EXPECT_EQ(kTrapezoid.integral(0.25), 0.0);
  EXPECT_EQ(kTrapezoid.integral(0.75), 0.125);
  EXPECT_EQ(kTrapezoid.integral(1.0), 0.5);
  EXPECT_EQ(kTrapezoid.integral(2.0), 2.5);
  EXPECT_EQ(kTrapezoid.integral(2.25), 2.625);
  EXPECT_EQ(kTrapezoid.integral(3.25), 1.625);
  EXPECT_EQ(PiecewiseLinear(3.0).integral(2.0), 6.0);
  // A knot before t = 0: the part of the piece after 0 alone counts.
  EXPECT_EQ(PiecewiseLinear({-1.0, 1.0}, {0.0, 2.0}).integral(1.0), 1.5);
}

TEST(PiecewiseLinear, ScalesAndMultiplies) {
  const PiecewiseLinear half = kTrapezoid.scaled(0.5);
  EXPECT_EQ(half.at(1.5), 1.0);
  EXPECT_EQ(half.integral(2.0), 1.25);
  const PiecewiseLinear product = kTrapezoid.product(PiecewiseLinear({0.0, 1.5}, {0.0, 3.0}));
  EXPECT_EQ(product.times(), (std::vector<double>{0.0, 0.5, 1.0, 1.5, 2.0, 2.25}));
  EXPECT_EQ(product.at(1.0), 4.0);
  EXPECT_EQ(product.at(1.5), 6.0);
  EXPECT_EQ(product.at(9.0), -3.0);
  EXPECT_EQ(PiecewiseLinear(2.0).product(kTrapezoid).at(1.5), 4.0);
  EXPECT_EQ(PiecewiseLinear(2.0).product(PiecewiseLinear(4.0)).at(0.0), 8.0);
}

TEST(PiecewiseLinear, KnowsItsRange) {
  EXPECT_EQ(kTrapezoid.lowest(), -1.0);
  EXPECT_EQ(kTrapezoid.highest(), 2.0);
  EXPECT_FALSE(kTrapezoid.is_constant());
  EXPECT_TRUE(PiecewiseLinear(1.0).is_constant());
  EXPECT_TRUE(PiecewiseLinear({0.0, 1.0}, {2.0, 2.0}).is_constant());
}

TEST(PiecewiseLinear, RefusesKnotsThatAreNoFunction) {
  EXPECT_THROW(PiecewiseLinear({0.0, 1.0}, {1.0}), InvalidInput);
  EXPECT_THROW(PiecewiseLinear({}, {}), InvalidInput);
  EXPECT_THROW(PiecewiseLinear({0.0, 0.0}, {1.0, 2.0}), InvalidInput);
  EXPECT_THROW(PiecewiseLinear({1.0, 0.0}, {1.0, 2.0}), InvalidInput);
  EXPECT_THROW(PiecewiseLinear({0.0}, {std::nan("")}), InvalidInput);
}

}  // namespace
}  // namespace modcal::piecewise_linear_test
