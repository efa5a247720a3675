// What is not known of a force above the measured band stands where the force does.
#include "libinverse/structure/force/force_band.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace modcal::force_band_test {
namespace {

// A burst of 3 N at 1200 Hz beside one of 5 N at 100 Hz, both 5 ms wide: their spectra are 32 Hz
// wide, so that a cut at 600 Hz leaves all of the first and none of the second. The envelope of the
// first is its Gaussian; phases of its oscillation must not show. Half a period of 600 Hz has 6
// samples; the burst is at its peak at the four-hundredth.
TEST(VarianceOfShape, IsTheLargestSquaredEnvelopeAboutASampleOfWhatStandsAboveTheBand) {
  const double rate = 8000.0;
  Eigen::VectorXd force(800), expected(800);
  for (Eigen::Index j = 0; j < force.size(); ++j) {
    const double t = static_cast<double>(j) / rate, turn = 2.0 * std::numbers::pi * t;
    const auto burst_at = [](double at) {
      return std::exp(-0.5 * std::pow((at - 0.05) / 5e-3, 2));
    };
    const double burst = burst_at(t);
    const double nearest = burst_at(std::clamp(0.05, t - 6.0 / rate, t + 6.0 / rate));
    force[j] = 3.0 * burst * std::cos(1200.0 * turn) + 5.0 * burst * std::cos(100.0 * turn + 1.0);
    expected[j] = 9.0 * nearest * nearest;
  }
  const Eigen::VectorXd found = variance_of_shape(force, rate, 600.0);
  EXPECT_LT((found - expected).cwiseAbs().maxCoeff(), 1e-10);
}

}  // namespace
}  // namespace modcal::force_band_test
