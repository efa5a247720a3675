#include "libcalib/identifiability/fitted_record.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include "tests/libcalib/likelihood/bowed_case.hpp"

namespace modcal::fitted_record_test {
namespace {

double rms(std::span<const double> samples) {
  double power = 0.0;
  for (const double x : samples) power += x * x / static_cast<double>(samples.size());
  return std::sqrt(power);
}

// A string a thousandth higher begins where the other does and leaves it with time: in the first
// 40 samples they are less apart than in the 2560 and 5120 of the record, save for what the edges
// of the band smear over its beginning.
TEST(FittedRecord, AnotherPolarizationBeginsAsTheStringDoes) {
  for (const double duration : {0.05, 0.1}) {
    const BowedCase bowed = bowed_case(0.0285, 1.39e-4, duration);
    const ProjectedLikelihood likelihood(
        WhitenedRecord::of(noisy(bowed, 0.01, 1), 0.0, 2.0 * std::numbers::pi * 10300.0));
    const FittedRecord fitted(likelihood, bowed.truth);
    const MisfitCause up = fitted.polarization(1e-3), down = fitted.polarization(-1e-3);
    const RealFft fft(bowed.clean[0].size());
    std::vector<Complex> spectrum(fft.bins());
    std::vector<double> apart(fft.length());
    for (std::size_t k = 0; k < likelihood.record().bins; ++k) {
      spectrum[k + 1] = up.columns[0].left.at(k) - down.columns[0].left.at(k);
    }
    fft.inverse(spectrum, apart);
    EXPECT_LT(rms(std::span(apart).first(40)), 0.3 * rms(apart)) << duration;
  }
}

// The force that the columns of a contact that moves are made of, (∂H_r/∂x_c) φ_j f, fades at both
// ends of the record, where what a fit takes for force belongs to the decays.
TEST(FittedRecord, AContactMovesInsideTheRecord) {
  const BowedCase bowed = bowed_case(0.0285, 1.39e-4, 0.3);
  const WhitenedRecord record =
      WhitenedRecord::of(noisy(bowed, 0.01, 1), 0.0, 2.0 * std::numbers::pi * 9000.0);
  const ProjectedLikelihood likelihood(record);
  const MisfitCause cause = FittedRecord(likelihood, bowed.truth).moving_contact();
  const RealFft fft(bowed.clean[0].size());
  const FrequencyGrid grid = FrequencyGrid::of_record(fft.length(), record.sample_rate);
  constexpr double kStep = 1e-7;
  std::array<std::vector<Complex>, 2> slope;
  for (const End end : {End::kLeft, End::kRight}) {
    const auto r = static_cast<std::size_t>(end);
    slope[r] = reaction_transfer(bowed.truth.basis, 0.0285 + kStep, end, grid);
    const auto below = reaction_transfer(bowed.truth.basis, 0.0285 - kStep, end, grid);
    for (std::size_t k = 0; k < slope[r].size(); ++k) {
      slope[r][k] = (slope[r][k] - below[k]) / (2.0 * kStep * record.deviation[r]);
    }
  }
  ASSERT_GE(cause.columns.size(), 2u);
  for (const SignalColumn& column : cause.columns) {
    std::vector<Complex> spectrum(fft.bins());
    std::vector<double> force(fft.length());
    for (std::size_t k = 0; k < record.bins; ++k) {
      const Complex left = slope[0][k + 1], right = slope[1][k + 1];
      spectrum[k + 1] =
          (std::conj(left) * column.left.at(k) + std::conj(right) * column.right.at(k)) /
          (std::norm(left) + std::norm(right));
    }
    fft.inverse(spectrum, force);
    // 6 ms of either end, less than a fit takes for its decays.
    EXPECT_LT(rms(std::span(force).first(300)), 0.01 * rms(force));
    EXPECT_LT(rms(std::span(force).last(300)), 0.01 * rms(force));
  }
}

}  // namespace
}  // namespace modcal::fitted_record_test
