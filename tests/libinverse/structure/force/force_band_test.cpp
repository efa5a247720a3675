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

// A band of 600 bins up to 600 Hz of 8 kHz. Harmonics of 150 Hz with 1/n² have 1 + 1/4 + 1/9 + 1/16
// there; above are Σ 1/n² from 5 on, .2213, of which half the sample rate, the 26th, leaves .1836.
// The sum is one over n from 4 to 26.7, 1/4 - .0375 = .2125.
TEST(PowerOfLinesOutside, IsThatOfTheHarmonicsAbove) {
  ContourSpectra spectra{.sample_rate = 8000.0, .samples = 8000};
  spectra.grid = FrequencyGrid::of_record(8000, 8000.0);
  spectra.bins = {1, 601};
  std::vector<double> lines(600, 0.0), noise(600, 1.0);
  for (std::size_t n = 1; n <= 4; ++n) lines[150 * n - 1] = 1.0 / static_cast<double>(n * n);
  EXPECT_NEAR(power_of_lines_outside(spectra, lines), 0.25 * (1.0 - 600.0 / 4000.0), 1e-12);
  EXPECT_EQ(power_of_lines_outside(spectra, noise), 0.0);
  std::vector<double> sine(600, 0.0);
  sine[498] = sine[499] = sine[500] = 1.0;
  EXPECT_EQ(power_of_lines_outside(spectra, sine), 0.0);
  // Less than nothing is found where noise is all there is.
  lines[300] = -5.0;
  EXPECT_NEAR(power_of_lines_outside(spectra, lines), 0.2125, 1e-12);
}

}  // namespace
}  // namespace modcal::force_band_test
