#include "libcalib/likelihood/records/whitened_record.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace modcal::whitened_record_test {
namespace {

// 20 000 draws: a power to 1/√20000 = 0.7 % of itself; five of them.
TEST(WhitenedRecord, DrawsNoiseOfItsCovariance) {
  WhitenedRecord record;
  record.bins = 20000;
  record.left = record.right = PlanarVector(record.bins);
  const NoiseCovariance truth{.left = 4.0, .right = 2.25, .mixed = -1.8};
  record.left_noise.assign(record.bins, truth.left);
  record.right_noise.assign(record.bins, truth.right);
  record.mixed_noise.assign(record.bins, truth.mixed);
  record.draw_noise(3);
  double left = 0.0, right = 0.0;
  std::complex<double> mixed = 0.0;
  const auto count = static_cast<double>(record.bins);
  for (std::size_t k = 0; k < record.bins; ++k) {
    left += std::norm(record.left.at(k)) / count;
    right += std::norm(record.right.at(k)) / count;
    mixed += record.left.at(k) * std::conj(record.right.at(k)) / count;
  }
  EXPECT_NEAR(left / truth.left, 1.0, 0.036);
  EXPECT_NEAR(right / truth.right, 1.0, 0.036);
  EXPECT_LT(std::abs(mixed - truth.mixed), 0.036 * std::sqrt(truth.left * truth.right));
}

}  // namespace
}  // namespace modcal::whitened_record_test
