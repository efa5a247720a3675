// Which bins of a contour a band holds.
#include "libinverse/structure/structure_record.hpp"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <complex>
#include <vector>

#include "libinverse/structure/force/force_band.hpp"

namespace modcal::structure_record_test {
namespace {

// 1 s at 100 Hz: bins 1 Hz apart.
ContourSpectra spectra_of(double sigma, double low) {
  StructureRecord record{.sample_rate = 100.0, .responses = {std::vector<double>(100, 1.0)}};
  return ContourSpectra::of(record, sigma, low, 40.0);
}

TEST(ContourSpectra, HoldsTheMeanWhereTheBandReachesDownToIt) {
  EXPECT_EQ(spectra_of(2.0, 0.4).bins.first, 0u);
  EXPECT_EQ(spectra_of(2.0, 0.6).bins.first, 1u);
  EXPECT_EQ(spectra_of(2.0, 3.0).bins.first, 3u);
  // On the axis an acceleration has none: H is 0 there.
  EXPECT_EQ(spectra_of(0.0, 0.4).bins.first, 1u);
}

TEST(ContourSpectra, NothingLiesBelowTheMean) {
  const ContourSpectra whole = spectra_of(2.0, 0.4), rest = spectra_of(2.0, 3.0);
  // A flat power of 1: bins 41 to 49 lie above the band, half of bin 2 and what is below it under.
  EXPECT_DOUBLE_EQ(power_outside(whole, std::vector<double>(whole.count(), 1.0)), 9.0);
  EXPECT_DOUBLE_EQ(power_outside(rest, std::vector<double>(rest.count(), 1.0)), 9.0 + 2.5);
}

// Of 100 samples and bins from `low` to 24 Hz: twice the covariance of real and imaginary parts
// that white noise has, over its power, sample by sample.
double farthest_from_noise(double low) {
  StructureRecord record{.sample_rate = 100.0, .responses = {std::vector<double>(100, 1.0)}};
  const ContourSpectra spectra = ContourSpectra::of(record, 2.0, low, 24.0);
  const auto bins = static_cast<Eigen::Index>(spectra.count());
  Eigen::MatrixXd parts(2 * bins, 100), correlation(2 * bins, 2 * bins);
  double power = 0.0;
  for (Eigen::Index j = 0; j < 100; ++j) {
    const double t = static_cast<double>(j) / 100.0;
    for (Eigen::Index m = 0; m < bins; ++m) {
      const Complex one = std::exp(-spectra.s(static_cast<std::size_t>(m)) * t);
      parts(2 * m, j) = one.real();
      parts(2 * m + 1, j) = one.imag();
    }
    power += std::exp(-2.0 * 2.0 * t);
  }
  const BinCorrelation multiplier(spectra);
  for (Eigen::Index i = 0; i < 2 * bins; ++i) {
    std::vector<Complex> column(spectra.count(), 0.0);
    column[static_cast<std::size_t>(i / 2)] = i % 2 == 0 ? Complex(1.0, 0.0) : Complex(0.0, 1.0);
    multiplier.multiply(column);
    for (Eigen::Index m = 0; m < bins; ++m) {
      const Complex value = column[static_cast<std::size_t>(m)];
      correlation.col(i).segment<2>(2 * m) << value.real(), value.imag();
    }
  }
  return (correlation - 2.0 / power * (parts * parts.transpose())).cwiseAbs().maxCoeff();
}

// As many instants as the 100 samples where the band begins at 0, when its lowest bin is real.
TEST(BinCorrelation, IsThatOfWhiteNoiseWithTheMeanAndWithoutIt) {
  EXPECT_LT(farthest_from_noise(0.4), 1e-12);
  EXPECT_LT(farthest_from_noise(3.0), 1e-12);
}

TEST(RiseTowardsZero, ComparesTheLowestOctaveWithTheNext) {
  std::vector<double> flat(300, 2.0), fall;
  EXPECT_DOUBLE_EQ(rise_towards_zero(flat, 20), 1.0);
  for (int k = 20; k < 320; ++k) fall.push_back(1.0 / (k * k));
  // Of 1/f²: the means over 20 … 39 and 40 … 79 are as 4 to 1 but for the sums' ends.
  EXPECT_NEAR(rise_towards_zero(fall, 20), 4.0, 0.1);
  EXPECT_TRUE(std::isnan(rise_towards_zero(std::vector<double>(50, 1.0), 20)));
  // Power that noise makes negative tells of none.
  EXPECT_EQ(rise_towards_zero(std::vector<double>(300, -1.0), 20), 0.0);
}

}  // namespace
}  // namespace modcal::structure_record_test
