#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "experiments/study/sample.hpp"
#include "libsim/base/error.hpp"
#include "libsim/base/random.hpp"

namespace modcal::paired_bootstrap_test {
namespace {

// Pairs (x_i e^{s z_i}, x_i) with log-normal x: common spread, ratio e^{shift}.
struct Pairs {
  std::vector<double> a, b;
};
Pairs pairs_of(std::size_t n, double shift, std::uint64_t seed) {
  std::vector<double> normal(2 * n);
  fill_standard_normal(StreamKey(seed), normal);
  Pairs pairs;
  for (std::size_t i = 0; i < n; ++i) {
    const double common = std::exp(normal[2 * i]);
    pairs.a.push_back(common * std::exp(shift + 0.2 * normal[2 * i + 1]));
    pairs.b.push_back(common);
  }
  return pairs;
}

TEST(PairedBootstrap, TellsADifferenceAndItsDirection) {
  const Pairs worse = pairs_of(40, 1.0, 3);
  EXPECT_TRUE(median_ratio(worse.a, worse.b).is_above_one());
  EXPECT_TRUE(median_ratio(worse.b, worse.a).is_below_one());
}

// 95 % intervals of 200 samples with ratio 1 hold it: the number outside is binomial, mean 10 for
// an exact interval; percentile intervals of medians are a little too wide or narrow. More than 24
// outside has a probability of 2e-5 at 5 %.
TEST(PairedBootstrap, SeldomClaimsADifferenceThatIsNone) {
  int claims = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Pairs same = pairs_of(20, 0.0, 100 + seed);
    const MedianRatio ratio = median_ratio(same.a, same.b);
    if (ratio.is_above_one() || ratio.is_below_one()) ++claims;
  }
  EXPECT_LE(claims, 24);
}

TEST(PairedBootstrap, ClaimsNothingFromAHandfulOfDrawsOrFromTies) {
  const std::vector<double> small = {1.0, 1.0, 1.0, 1.0}, large = {9.0, 9.0, 9.0, 9.0};
  EXPECT_FALSE(median_ratio(small, large).is_below_one());
  const std::vector<double> failed(10, 1e300);
  const MedianRatio tie = median_ratio(failed, failed);
  EXPECT_EQ(tie.ratio, 1.0);
  EXPECT_EQ(tie.low, 1.0);
  EXPECT_EQ(tie.high, 1.0);
  EXPECT_THROW(median_ratio(small, failed), InvalidInput);
  EXPECT_THROW(median_ratio({}, {}), InvalidInput);
}

}  // namespace
}  // namespace modcal::paired_bootstrap_test
