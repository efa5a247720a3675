#include "libsim/base/decaying_exp.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace modcal::decaying_exp_test {
namespace {

TEST(DecayingExp, IsTheLibrarysToOneUlp) {
  for (int k = 0; k <= 2'000'000; ++k) {
    const double x = -690.0 * std::pow(k / 2e6, 3.0);
    const long double expected = std::exp(static_cast<long double>(x));
    // Of an ulp, at most 2.2e-16 of the value: half of the table's rounding, half of the last
    // sum's, the tail (at most 0.011 of the value) with a few roundings, and what the polynomial
    // leaves.
    ASSERT_NEAR(static_cast<double>(decaying_exp(x) / expected - 1.0L), 0.0, 1.2 * 2.22e-16) << x;
  }
}

TEST(DecayingExp, KeepsItsEnds) {
  EXPECT_EQ(decaying_exp(0.0), 1.0);
  EXPECT_EQ(decaying_exp(-0.0), 1.0);
  EXPECT_LT(decaying_exp(-1e300), 1e-299);
  EXPECT_GT(decaying_exp(-1e300), 1e-300);
  EXPECT_GE(decaying_exp(-HUGE_VAL), 0.0);
  EXPECT_TRUE(std::isnan(decaying_exp(std::nan(""))));
}

}  // namespace
}  // namespace modcal::decaying_exp_test
