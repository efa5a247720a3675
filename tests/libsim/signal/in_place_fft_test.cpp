#include <gtest/gtest.h>

#include <algorithm>

#include "libsim/base/error.hpp"
#include "libsim/base/random.hpp"
#include "libsim/signal/fft.hpp"

namespace modcal::in_place_fft_test {
namespace {

class EveryInPlaceLength : public testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(InPlaceFft, EveryInPlaceLength,
                         testing::Values(1, 2, 3, 4, 5, 97, 100, 101, 4096, 51200));

// log₂ K stages, each of which rounds: 1e-15 of the largest bin is ample.
TEST_P(EveryInPlaceLength, IsTheTransformOfRealFft) {
  const std::size_t length = GetParam();
  const InPlaceFft in_place(length);
  std::vector<double> samples(length);
  fill_standard_normal(StreamKey(1), samples);
  std::vector<Complex> memory(in_place.bins());
  std::copy(samples.begin(), samples.end(), in_place.samples_in(memory).begin());
  in_place.forward(memory);
  const std::vector<Complex> expected = RealFft(length).forward(samples);
  double largest = 0.0;
  for (const Complex value : expected) largest = std::max(largest, std::abs(value));
  for (std::size_t k = 0; k < memory.size(); ++k) {
    EXPECT_LT(std::abs(memory[k] - expected[k]), 1e-14 * largest) << k;
  }
  in_place.inverse(memory);
  for (std::size_t j = 0; j < length; ++j) {
    EXPECT_NEAR(in_place.samples_in(memory)[j], static_cast<double>(length) * samples[j],
                1e-13 * static_cast<double>(length));
  }
}

TEST(InPlaceFft, GivesTheSameBitsAtAnyPlaceInMemory) {
  const std::size_t length = 1000;
  const InPlaceFft in_place(length);
  std::vector<double> samples(length);
  fill_standard_normal(StreamKey(2), samples);
  std::vector<Complex> reference;
  std::vector<Complex> memory(in_place.bins() + 3);
  for (std::size_t offset = 0; offset < 4; ++offset) {
    const std::span<Complex> part = std::span(memory).subspan(offset, in_place.bins());
    std::copy(samples.begin(), samples.end(), in_place.samples_in(part).begin());
    in_place.forward(part);
    if (offset == 0) reference.assign(part.begin(), part.end());
    EXPECT_TRUE(std::equal(part.begin(), part.end(), reference.begin())) << offset;
  }
  EXPECT_THROW(InPlaceFft(0), InvalidInput);
}

}  // namespace
}  // namespace modcal::in_place_fft_test
