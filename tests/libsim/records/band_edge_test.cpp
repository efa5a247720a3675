// A record that a digital low-pass has emptied.
#include "libsim/records/band_edge.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "libsim/base/random.hpp"
#include "libsim/records/tuning.hpp"
#include "libsim/signal/fft.hpp"

namespace modcal::band_edge_test {
namespace {

// Noise whose bins above a share of the sampling rate are `left` times what they were.
std::vector<double> noise(std::size_t count, double edge, double left) {
  std::vector<double> samples(count);
  fill_standard_normal(StreamKey(7).with("band edge"), samples);
  const RealFft fft(count);
  std::vector<Complex> bins = fft.forward(samples);
  for (std::size_t k = 0; k < bins.size(); ++k) {
    if (static_cast<double>(k) > edge * static_cast<double>(count)) bins[k] *= left;
  }
  return fft.inverse(std::move(bins));
}

TEST(BandEdge, IsFoundToABand) {
  for (const double edge : {0.1, 0.312, 0.39}) {
    const std::optional<BandEdge> found = find_band_edge(noise(20000, edge, 1e-4));
    ASSERT_TRUE(found) << edge;
    EXPECT_NEAR(found->from, edge, 0.0051);  // a band
    EXPECT_NEAR(std::log10(found->share), -8.0, 1.0);
  }
}

TEST(BandEdge, IsNoneOfNoiseOfASteepSlopeOrOfAnAntiAliasingFilter) {
  EXPECT_FALSE(find_band_edge(noise(20000, 1.0, 1.0)));
  EXPECT_FALSE(find_band_edge(noise(20000, 0.3, 0.1)));    // 20 dB
  EXPECT_FALSE(find_band_edge(noise(20000, 0.45, 1e-4)));  // the stop band of a converter
  // 1/f² from 0.05 sampling rates on, lines on it.
  std::vector<double> samples = noise(20000, 1.0, 1.0);
  const RealFft fft(samples.size());
  std::vector<Complex> bins = fft.forward(samples);
  for (std::size_t k = 1000; k < bins.size(); ++k) {
    bins[k] *= std::pow(1000.0 / static_cast<double>(k), 2) * (k % 200 == 0 ? 1e4 : 1.0);
  }
  EXPECT_FALSE(find_band_edge(fft.inverse(std::move(bins))));
}

TEST(BandEdge, IsNotLookedForInAShortRecord) {
  EXPECT_FALSE(find_band_edge(noise(kShortestBandRecord - 1, 0.3, 1e-4)));
  EXPECT_TRUE(find_band_edge(noise(kShortestBandRecord, 0.3, 1e-4)));
}

}  // namespace
}  // namespace modcal::band_edge_test
