// Which bins of a contour a band holds.
#include "libinverse/structure/structure_record.hpp"

#include <gtest/gtest.h>

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

TEST(RiseTowardsZero, ComparesTheLowestOctaveWithTheNext) {
  std::vector<double> flat(300, 2.0), fall;
  EXPECT_DOUBLE_EQ(rise_towards_zero(flat, 20), 1.0);
  for (int k = 20; k < 320; ++k) fall.push_back(1.0 / (k * k));
  // Of 1/f²: the means over 20 … 39 and 40 … 79 are as 4 to 1 but for the sums' ends.
  EXPECT_NEAR(rise_towards_zero(fall, 20), 4.0, 0.1);
  EXPECT_EQ(rise_towards_zero(std::vector<double>(50, 1.0), 20), 0.0);
  // Power that noise makes negative tells of none.
  EXPECT_EQ(rise_towards_zero(std::vector<double>(300, -1.0), 20), 0.0);
}

}  // namespace
}  // namespace modcal::structure_record_test
