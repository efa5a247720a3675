#include <gtest/gtest.h>

#include <cmath>

#include "libsim/base/error.hpp"
#include "libsim/base/random.hpp"
#include "libsim/dynamics/friction/friction_law.hpp"

namespace modcal::sliding_laws_test {
namespace {

SlidingPoint point(const SlidingLaw& law, double speed) {
  return std::visit([speed](const auto& l) { return l.at(speed); }, law);
}

double steepest_fall(const SlidingLaw& law) {
  return std::visit([](const auto& l) { return l.steepest_fall(); }, law);
}

class SlidingLaws : public testing::TestWithParam<std::string_view> {
 protected:
  std::shared_ptr<const FrictionLaw> law() const { return Choice<FrictionLaw>(GetParam()).make(); }
};

TEST_P(SlidingLaws, DerivativesAreThoseOfTheForce) {
  const SlidingLaw sliding = law()->sliding(2.0);
  for (const double u : {1e-3, 0.05, 0.4, 3.0}) {
    const double h = 1e-4 * u;
    const SlidingPoint at = point(sliding, u), below = point(sliding, u - h),
                       above = point(sliding, u + h);
    // Central differences: h²/6 times the next derivative, and rounding 1e-16/h; both below 1e-6 of
    // the derivative's own scale F/u.
    EXPECT_NEAR(at.slope, (above.force - below.force) / (2.0 * h), 1e-6 * at.force / u);
    EXPECT_NEAR(at.curvature, (above.slope - below.slope) / (2.0 * h), 1e-6 * at.force / (u * u));
    EXPECT_LE(-at.slope, steepest_fall(sliding));
  }
}

TEST_P(SlidingLaws, AreProportionalToTheNormalForce) {
  const SlidingLaw coefficient = law()->sliding(1.0), sliding = law()->sliding(3.0);
  for (const double u : {0.0, 0.02, 0.7}) {
    EXPECT_DOUBLE_EQ(3.0 * point(coefficient, u).force, point(sliding, u).force);
    EXPECT_DOUBLE_EQ(3.0 * point(coefficient, u).slope, point(sliding, u).slope);
  }
  EXPECT_DOUBLE_EQ(3.0 * law()->static_limit(1.0), law()->static_limit(3.0));
}

// Passivity: the force −sgn(v) g(|v|) never does work on the pair, g ≥ 0, and sliding never holds
// more than adherence can.
TEST_P(SlidingLaws, NeverGiveEnergy) {
  std::vector<double> u(1000);
  fill_uniform(StreamKey(1).with(GetParam()), u);
  const SlidingLaw sliding = law()->sliding(1.5);
  for (const double share : u) {
    const double speed = std::pow(10.0, -9.0 + 11.0 * share);
    const double force = point(sliding, speed).force;
    EXPECT_GE(force, 0.0);
    EXPECT_LE(force, law()->static_limit(1.5) * (1.0 + 1e-15));
  }
}

INSTANTIATE_TEST_SUITE_P(All, SlidingLaws, testing::Values("coulomb_exponential", "hyperbolic"));

TEST(Hyperbolic, IsItsFormula) {
  const Hyperbolic law({.static_coefficient = 0.8, .dynamic_coefficient = 0.3, .half_speed = 0.1});
  const SlidingLaw sliding = law.sliding(2.0);
  EXPECT_DOUBLE_EQ(point(sliding, 0.0).force, 1.6);
  EXPECT_DOUBLE_EQ(point(sliding, 0.1).force, 1.1);                 // half of the fall
  EXPECT_DOUBLE_EQ(point(sliding, 0.9).force, 2.0 * (0.3 + 0.05));  // a tenth is left
  EXPECT_DOUBLE_EQ(steepest_fall(sliding), 10.0);
  EXPECT_DOUBLE_EQ(law.static_limit(2.0), 1.6);
}

TEST(Hyperbolic, RefusesARisingLaw) {
  EXPECT_THROW(Hyperbolic({.static_coefficient = 0.1, .dynamic_coefficient = 0.2}), InvalidInput);
  EXPECT_THROW(Hyperbolic({.half_speed = 0.0}), InvalidInput);
}

}  // namespace
}  // namespace modcal::sliding_laws_test
