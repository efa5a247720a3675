#include <gtest/gtest.h>

#include <vector>

#include "libinverse/spectral/choices/rules.hpp"

namespace modcal::interior_minimum_test {
namespace {

TEST(MostProminentMinimum, IsTheOneHardestToLeave) {
  // Minima at 1, 3 and 6. The lowest, 1 at index 6, is left over a barrier of 3 towards the 0.5
  // behind it; 10 at index 3 is left over 100 on its lower side, 30 at index 1 over 100.
  const std::vector<double> values = {200, 30, 100, 10, 150, 2, 1, 3, 0.5};
  const auto minimum = most_prominent_minimum(values);
  ASSERT_TRUE(minimum.has_value());
  EXPECT_EQ(minimum->index, 3u);
  EXPECT_EQ(minimum->count, 3u);
  EXPECT_NEAR(minimum->prominence, 1.1760912590556813, 1e-15);  // log10(150/10)
}

TEST(MostProminentMinimum, TakesTheMiddleOfAPlateau) {
  const auto minimum = most_prominent_minimum(std::vector<double>{5, 1, 1, 1, 2});
  ASSERT_TRUE(minimum.has_value());
  EXPECT_EQ(minimum->index, 2u);
}

TEST(MostProminentMinimum, KnowsNoMinimumAtTheEnds) {
  EXPECT_FALSE(most_prominent_minimum(std::vector<double>{5, 4, 3, 2, 1, 0}));
  EXPECT_FALSE(most_prominent_minimum(std::vector<double>{1, 2, 3}));
  EXPECT_FALSE(most_prominent_minimum(std::vector<double>{3, 1, 1}));
  EXPECT_FALSE(most_prominent_minimum(std::vector<double>{1, 1, 3}));
  EXPECT_FALSE(most_prominent_minimum(std::vector<double>{2, 0, 3}));  // nothing left, no minimum
  EXPECT_FALSE(most_prominent_minimum(std::vector<double>{2, 1}));
  EXPECT_FALSE(most_prominent_minimum({}));
}

}  // namespace
}  // namespace modcal::interior_minimum_test
