#include "libinverse/structure/strikes/strike_weights.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libinverse/structure/strikes/strike_fit.hpp"
#include "libinverse/structure/tuning.hpp"

namespace modcal::strike_weights_test {
namespace {

// Bins 0.5 Hz apart, one of them of |y|² = 25: a thirteenth of it is the mean over 3 Hz to both
// sides, and the floor is a hundredth of the mean of all.
TEST(StrikeWeights, AreOfTheResponseWithinThreeHertz) {
  constexpr std::size_t kBins = 101, kPeak = 50;
  ContourSpectra spectra;
  spectra.grid.spacing = 2.0 * std::numbers::pi * 0.5;
  spectra.responses.assign(1, std::vector<Complex>(kBins));
  spectra.responses[0][kPeak] = Complex(3.0, 4.0);
  const BinWeights weights = weights_of(spectra, 0.2);
  ASSERT_EQ(weights.size(), 1u);
  ASSERT_EQ(weights[0].size(), kBins);
  const double floor = 0.01 * 25.0 / 101.0;
  for (std::size_t m = 0; m < kBins; ++m) {
    const bool near = m + 6 >= kPeak && m <= kPeak + 6;
    const double deviation = 0.2 * std::sqrt((near ? 25.0 / 13.0 : 0.0) + floor);
    EXPECT_NEAR(weights[0][m] * deviation, 1.0, 1e-13) << m;  // sums of 101 terms
  }
}

// Powers that are what they are expected to be, ε² of the modes' and noise: the likelihood is
// largest there, to what 200 multiplicative steps leave.
TEST(SensorScatterOf, ExpectedPowersIsTheirOwn) {
  std::vector<double> modal, left;
  for (int m = 0; m < 200; ++m) {
    modal.push_back(std::exp(-0.05 * m));
    left.push_back(0.03 * 0.03 * modal.back() + 2.0 * 4e-6);
  }
  const SensorScatter found = scatter_of(left, modal, 2.0, 1.0);
  EXPECT_NEAR(found.modal, 0.03, 3e-5);
  EXPECT_NEAR(found.noise, 2e-3, 2e-6);
}

// A pole beyond the band stands for what no other explains, whatever damping is left of it.
TEST(StrikeFitWithoutDamping, LooksAtTheModesOfTheBand) {
  StrikeFit fit;
  fit.table.low = 10.0, fit.table.high = 600.0;
  for (const double f : {100.0, 610.0}) {
    fit.table.model.poles.push_back({.omega = 2.0 * std::numbers::pi * f, .zeta = 0.01});
  }
  fit.table.model.poles[1].zeta = kLeastDampingRatio;
  EXPECT_EQ(fit.without_damping(), "");
  fit.table.model.poles[0].zeta = kLeastDampingRatio;
  EXPECT_EQ(fit.without_damping(), "rejected: no damping is left of the mode at 100 Hz");
}

}  // namespace
}  // namespace modcal::strike_weights_test
