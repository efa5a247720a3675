// Every instruction set of the kernels against plain loops: a machine runs but one of them.
#include "libsim/dynamics/event/modes/modal_kernels.hpp"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cmath>
#include <complex>

#include "libsim/base/random.hpp"

namespace modcal::event::modal_kernels_test {
namespace {

/// Runs the test once for every instruction set that this machine has.
class EverySet : public testing::TestWithParam<std::int64_t> {
 protected:
  void SetUp() override { allow(GetParam()); }
  void TearDown() override { allow(0); }

 private:
  static void allow(std::int64_t target) {
    hwy::SetSupportedTargetsForTest(target);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  }
};

INSTANTIATE_TEST_SUITE_P(Sets, EverySet, testing::ValuesIn(hwy::SupportedAndGeneratedTargets()),
                         [](const auto& set) { return std::string(hwy::TargetName(set.param)); });

std::vector<double> draw(std::size_t count, std::uint64_t seed) {
  std::vector<double> values(count);
  fill_standard_normal(StreamKey(seed), values);
  return values;
}

TEST_P(EverySet, PolynomialsAreTheSumsOfPowers) {
  const std::vector<double> values = draw(7 * kVectorPadding, 1);
  std::vector<Octet> table(7);
  for (std::size_t p = 0; p < 7; ++p) {
    for (std::size_t k = 0; k < kVectorPadding; ++k) table[p][k] = values[kVectorPadding * p + k];
  }
  const std::array<double, 4> x = {0.0, 0.3, -0.7, 1.0};
  std::array<Octet, 4> found{};
  modal_kernels_of_allowed_set().polynomials(table, x, found);
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t k = 0; k < kVectorPadding; ++k) {
      double sum = 0.0, size = 0.0;
      for (std::size_t p = 0; p < 7; ++p) {
        const double term = table[p][k] * std::pow(x[i], static_cast<double>(p));
        sum += term;
        size += std::abs(term);
      }
      // Seven terms, a few roundings of 1.1e-16 each.
      EXPECT_NEAR(found[i][k], sum, 20 * 1.1e-16 * size) << i << " " << k;
    }
  }
}

TEST_P(EverySet, WeightedSizeIsTheSumOfAbsoluteParts) {
  const std::size_t modes = 13;  // no multiple of any vector
  const std::vector<double> values = draw(3 * modes, 2);
  PlanarVector state(modes);
  AlignedVector weight(padded_size(modes), 0.0);
  double expected = 0.0;
  for (std::size_t n = 0; n < modes; ++n) {
    weight[n] = std::abs(values[3 * n]);
    state.set(n, {values[3 * n + 1], values[3 * n + 2]});
    expected += weight[n] * (std::abs(values[3 * n + 1]) + std::abs(values[3 * n + 2]));
  }
  EXPECT_NEAR(modal_kernels_of_allowed_set().weighted_size(weight, state), expected,
              13 * 3e-16 * expected);
}

TEST_P(EverySet, AdvanceByMultipliesEveryModeByItsExponential) {
  const std::size_t modes = 13;
  const std::vector<double> values = draw(2 * modes, 3);
  PlanarVector pole(modes), state(modes), found(modes);
  SumAndRate expected;
  const double time = 0.37;
  for (std::size_t n = 0; n < modes; ++n) {
    pole.set(n, {-0.1 * static_cast<double>(n), 2.0 * static_cast<double>(n + 1)});
    state.set(n, {values[2 * n], values[2 * n + 1]});
    const std::complex<double> moved = std::exp(time * pole.at(n)) * state.at(n);
    expected.sum += moved.real();
    expected.rate += (pole.at(n) * moved).real();
  }
  const SumAndRate sums = modal_kernels_of_allowed_set().advance_by(time, pole, state, found);
  for (std::size_t n = 0; n < modes; ++n) {
    const std::complex<double> moved = std::exp(time * pole.at(n)) * state.at(n);
    // An exponential of a few ulp of a phase up to 10.
    EXPECT_LT(std::abs(found.at(n) - moved), 1e-14 * std::abs(moved)) << n;
  }
  EXPECT_NEAR(sums.sum, expected.sum, 13 * 1e-14 * 3.0);
  EXPECT_NEAR(sums.rate, expected.rate, 13 * 26.0 * 1e-14 * 3.0);
}

}  // namespace
}  // namespace modcal::event::modal_kernels_test
