#include "libcalib/optimizers/staged/best_tests.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace modcal::best_tests_test {
namespace {

ScoreTest test_at(double place, double statistic, double log_evidence,
                  const Eigen::Matrix2d& untold) {
  return {.cause = "a cause",
          .place = place,
          .statistic = statistic,
          .degrees = 2,
          .log_p = -statistic,
          .shift_per_root = 10.0 - statistic,
          .untold = untold,
          .log_evidence = log_evidence};
}

// Evidences 1 : 3, so that what the first leaves untold counts a third. By hand: the diagonal has
// the most of (4, 1)/3 and (1, 9), and the correlation of the sum, (1/3 + 2)/√(7/3 · 28/3).
TEST(BestTests, WeighWhatIsUntoldByTheEvidence) {
  const ScoreTest weak = test_at(100.0, 5.0, 0.7, Eigen::Matrix2d{{4.0, 1.0}, {1.0, 1.0}});
  const ScoreTest strong =
      test_at(200.0, 6.0, 0.7 + std::log(3.0), Eigen::Matrix2d{{1.0, 2.0}, {2.0, 9.0}});
  for (const bool weak_first : {true, false}) {
    BestTests tests;
    tests.add(weak_first ? weak : strong);
    tests.add(weak_first ? strong : weak);
    const std::vector<ScoreTest> found = tests.take();
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].place, 200.0);
    EXPECT_EQ(found[0].statistic, 6.0);
    EXPECT_EQ(found[0].shift_per_root, 5.0);
    EXPECT_DOUBLE_EQ(found[0].log_p, -6.0 + std::log(2.0));  // the better one of two
    // A few roundings of numbers up to 9.
    EXPECT_NEAR(found[0].untold(0, 0), 4.0 / 3.0, 1e-14);
    EXPECT_NEAR(found[0].untold(1, 1), 9.0, 1e-14);
    const double correlation = (1.0 / 3.0 + 2.0) / std::sqrt(7.0 / 3.0 * 28.0 / 3.0);
    EXPECT_NEAR(found[0].untold(0, 1), correlation * std::sqrt(4.0 / 3.0 * 9.0), 1e-14);
  }
}

TEST(BestTests, NeverMakeAChanceLargerThanOne) {
  BestTests tests;
  for (int i = 0; i < 5; ++i) {
    tests.add(test_at(100.0, 0.1, 0.0, Eigen::Matrix2d::Identity()));
  }
  EXPECT_EQ(tests.take()[0].log_p, 0.0);
}

}  // namespace
}  // namespace modcal::best_tests_test
