#include "libsim/base/decaying_exp.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace modcal {
namespace {

TEST(DecayingExp, IsTheLibrarysToOneUlp) {
  for (int k = 0; k <= 2'000'000; ++k) {
    const double x = -708.0 * std::pow(k / 2e6, 3.0);
    const double expected = std::exp(x);
    // Half an ulp of the library, half of the last product, and what the polynomial leaves.
    ASSERT_NEAR(decaying_exp(x), expected, 1.5 * 2.22e-16 * expected) << x;
  }
}

TEST(DecayingExp, KeepsItsEnds) {
  EXPECT_EQ(decaying_exp(0.0), 1.0);
  EXPECT_EQ(decaying_exp(-0.0), 1.0);
  EXPECT_LT(decaying_exp(-1e300), 1e-307);
  EXPECT_GE(decaying_exp(-HUGE_VAL), 0.0);
  EXPECT_TRUE(std::isnan(decaying_exp(std::nan(""))));
}

}  // namespace
}  // namespace modcal
