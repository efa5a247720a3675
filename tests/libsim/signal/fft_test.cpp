#include "libsim/signal/fft.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <thread>

#include "libsim/base/error.hpp"
#include "libsim/base/random.hpp"

namespace modcal::fft_test {
namespace {

std::vector<double> noise(std::size_t length) {
  std::vector<double> samples(length);
  fill_standard_normal(StreamKey(17).with(static_cast<std::uint64_t>(length)), samples);
  return samples;
}

class EveryLength : public testing::TestWithParam<std::size_t> {
 protected:
  // Roundings of an FFT grow like log K; primes go through a longer convolution.
  double tolerance() const { return 1e-14 * (4.0 + std::log2(static_cast<double>(GetParam()))); }
};

INSTANTIATE_TEST_SUITE_P(RealFft, EveryLength,
                         testing::Values(1, 2, 3, 4, 7, 16, 97, 100, 101, 1009, 1024, 5120));

TEST_P(EveryLength, SumsWithTheNegativeExponent) {
  const std::size_t length = GetParam();
  const std::vector<double> samples = noise(length);
  const std::vector<Complex> spectrum = RealFft(length).forward(samples);
  ASSERT_EQ(spectrum.size(), length / 2 + 1);
  const double scale = std::sqrt(static_cast<double>(length));
  const std::size_t stride = length < 200 ? 1 : length / 29;
  for (std::size_t k = 0; k < spectrum.size(); k += stride) {
    Complex expected = 0.0;
    for (std::size_t j = 0; j < length; ++j) {
      const double turn = static_cast<double>(j * k % length) / static_cast<double>(length);
      expected += std::polar(samples[j], -2.0 * std::numbers::pi * turn);
    }
    // The reference sum itself rounds K times.
    const double summing = 1e-16 * static_cast<double>(length);
    EXPECT_NEAR(std::abs(spectrum[k] - expected), 0.0, (tolerance() + summing) * scale) << k;
  }
}

TEST_P(EveryLength, ComesBack) {
  const std::size_t length = GetParam();
  const std::vector<double> samples = noise(length);
  const RealFft fft(length);
  const std::vector<double> back = fft.inverse(fft.forward(samples));
  for (std::size_t j = 0; j < length; ++j) EXPECT_NEAR(back[j], samples[j], tolerance());
}

TEST_P(EveryLength, KeepsThePower) {
  const std::size_t length = GetParam();
  const std::vector<double> samples = noise(length);
  const std::vector<Complex> spectrum = RealFft(length).forward(samples);
  double in_time = 0.0, in_frequency = 0.0;
  for (const double value : samples) in_time += value * value;
  for (std::size_t k = 0; k < spectrum.size(); ++k) {
    in_frequency += bin_multiplicity(k, length) * std::norm(spectrum[k]);
  }
  EXPECT_NEAR(in_frequency / static_cast<double>(length), in_time, tolerance() * in_time);
}

TEST_P(EveryLength, HasTheDegreesOfFreedomOfTheSamples) {
  const std::size_t length = GetParam();
  double freedom = 0.0;
  for (std::size_t k = 0; k <= length / 2; ++k) freedom += bin_multiplicity(k, length);
  EXPECT_EQ(freedom, static_cast<double>(length));
}

TEST(RealFft, GivesACosineItsPhase) {
  const std::size_t length = 60;
  std::vector<double> samples(length);
  for (std::size_t j = 0; j < length; ++j) {
    samples[j] = std::cos(2.0 * std::numbers::pi * 7.0 * static_cast<double>(j) / 60.0 + 0.3);
  }
  const std::vector<Complex> spectrum = RealFft(length).forward(samples);
  EXPECT_NEAR(std::abs(spectrum[7] - std::polar(30.0, 0.3)), 0.0, 1e-12);
}

TEST(RealFft, DoesNotTouchItsInput) {
  const std::vector<double> samples = noise(96);
  std::vector<double> copy = samples;
  std::vector<Complex> spectrum(49);
  RealFft(96).forward(copy, spectrum);
  EXPECT_EQ(copy, samples);
}

TEST(RealFft, GivesTheSameBitsFromSeveralThreads) {
  const std::vector<double> samples = noise(5120);
  const std::vector<Complex> expected = RealFft(5120).forward(samples);
  std::vector<std::vector<Complex>> results(4);
  std::vector<std::thread> threads;
  for (auto& result : results) {
    threads.emplace_back([&] { result = RealFft(5120).forward(samples); });
  }
  for (std::thread& thread : threads) thread.join();
  for (const auto& result : results) EXPECT_EQ(result, expected);
}

TEST(RealFft, RefusesAnEmptyRecord) { EXPECT_THROW(RealFft(0), InvalidInput); }

}  // namespace
}  // namespace modcal::fft_test
