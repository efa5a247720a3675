#include "libinverse/waves/end_search.hpp"

#include <gtest/gtest.h>

namespace modcal::end_search_test {
namespace {

// By hand: a²|R₁|² + b²|R₂|² = 16 + 81, 2ab Re R₁R₂* = 24, v = 4/2 + 9/4 + 97/100.
TEST(EndBins, MisfitIsTheSquareOverWhatNoiseAndTheRelationAllow) {
  EndBins bins{.frequency = {100.0, 200.0},
               .left = {4.0, 1.0},
               .right = {9.0, 1.0},
               .product = {2.0, 1.0 + 1e-15},
               .variance = {0.5, 0.25},
               .error = 0.1};
  const auto [same, turned] = bins.misfits(0, 2.0, 3.0);
  EXPECT_DOUBLE_EQ(same, 1.0 + 73.0 / 5.22);
  EXPECT_DOUBLE_EQ(turned, 1.0 + 121.0 / 5.22);
  EXPECT_EQ(bins.misfits(1, 1.0, 1.0)[0], 1.0);  // no less than nothing by rounding
  bins.variance = {0.0, 0.0};
  bins.error = 0.0;
  EXPECT_EQ(bins.misfits(0, 2.0, 3.0), (std::array{1.0, 1.0}));
}

}  // namespace
}  // namespace modcal::end_search_test
