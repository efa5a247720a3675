#include "libsim/model/transfer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <tuple>

#include "libsim/model/damping.hpp"

namespace modcal::transfer_test {
namespace {

StringModel violin_g() {
  StringModel string;
  string.length = 0.33;
  string.linear_density = 3.1e-3;
  string.fundamental = 196.0;
  return string;
}

TEST(ReactionTransfer, EqualsTheSumOverModesWrittenWithComplexNumbers) {
  const ModalBasis basis = make_modal_basis(violin_g());
  FrequencyGrid grid = FrequencyGrid::of_record(51, 51200.0);
  for (const double sigma : {0.0, 3.0}) {
    grid.sigma = sigma;
    for (const End end : {End::kLeft, End::kRight}) {
      const auto transfer = reaction_transfer(basis, 0.03, end, grid);
      for (std::size_t k = 0; k < grid.bins; ++k) {
        const Complex s{sigma, grid.omega(k)};
        Complex expected = 0.0;
        double magnitude = 0.0;
        for (std::size_t n = 1; n <= 50; ++n) {
          const double w = basis.omega[n - 1];
          const double sign = end == End::kLeft || n % 2 == 1 ? -1.0 : 1.0;
          const Complex term = sign * basis.tension * static_cast<double>(n) * std::numbers::pi /
                               0.33 *
                               std::sin(static_cast<double>(n) * std::numbers::pi * 0.03 / 0.33) /
                               (basis.mass[n - 1] * (w * w + s * s + 2e-3 * w * s));
          expected += term;
          magnitude += std::abs(term);
        }
        // 50 terms of a few roundings each; s² and ω_n² cancel by at most 1/(2ζ) = 500.
        EXPECT_NEAR(std::abs(transfer[k] - expected), 0.0, 50 * 500 * 2.3e-16 * magnitude);
      }
    }
  }
}

TEST(ReactionTransfer, StaticForceIsSharedByTheEndsLikeALever) {
  // At s = 0 the sum over all modes is −(1 − x_c/L) at x = 0 and −x_c/L at x = L; the terms
  // behind mode N alternate like sin(nπx/L)/n, so their sum is below 2/(π N sin(π x_c/2L)).
  StringModel string = violin_g();
  string.modes = 5000;
  const ModalBasis basis = make_modal_basis(string);
  const FrequencyGrid grid{.spacing = 1.0, .bins = 1};
  const double beta = 0.03 / 0.33;
  const double bound = 2.0 / (std::numbers::pi * 5000 * std::sin(std::numbers::pi * beta / 2));
  EXPECT_NEAR(reaction_transfer(basis, 0.03, End::kLeft, grid)[0].real(), -(1 - beta), bound);
  EXPECT_NEAR(reaction_transfer(basis, 0.03, End::kRight, grid)[0].real(), -beta, bound);
}

class StaticSeries : public testing::TestWithParam<std::tuple<double, bool>> {};
INSTANTIATE_TEST_SUITE_P(StringTransfer, StaticSeries,
                         testing::Combine(testing::Values(0.0, 1.4e-4, 0.02), testing::Bool()));

TEST_P(StaticSeries, ClosedFormIsTheLimitOfTheSum) {
  const auto [inharmonicity, bending] = GetParam();
  StringModel string;
  string.length = 0.33;
  string.linear_density = 3.1e-3;
  string.fundamental = 196.0;
  string.inharmonicity = inharmonicity;
  string.modes = 40000;
  const ModalBasis basis = make_modal_basis(string);
  for (const double contact : {0.001, 0.03, 0.165, 0.3}) {
    const StaticResponse all = static_response(basis, contact, bending);
    const StaticResponse sum = static_response_of_modes(basis, contact, bending);
    // Partial sums of sin(nx)/n stay 1/(N sin(x/2)) from the limit, others far less.
    const double x = std::numbers::pi * contact / basis.length;
    const double left = 2.0 / (40000.0 * std::numbers::pi * std::sin(0.5 * x));
    const double right = 2.0 / (40000.0 * std::numbers::pi * std::cos(0.5 * x));
    EXPECT_NEAR(sum.reaction[0], all.reaction[0], left);
    EXPECT_NEAR(sum.reaction[1], all.reaction[1], right);
    // Σ_{n > N} sin²(nx)/n² < 1/N.
    EXPECT_NEAR(
        sum.compliance, all.compliance,
        2.0 * basis.length / (40000.0 * basis.tension * std::numbers::pi * std::numbers::pi));
    if (bending || inharmonicity == 0.0) {
      EXPECT_NEAR(all.reaction[0], -(1.0 - contact / basis.length), 1e-12);
      EXPECT_NEAR(all.reaction[1], -contact / basis.length, 1e-12);
    }
  }
}

TEST(SineShape, IsZeroAtNodes) {
  EXPECT_EQ(sine_shape(2, 0.5), 0.0);
  EXPECT_LT(std::abs(sine_shape(11, 0.03 / 0.33)), 1e-15);
}

}  // namespace
}  // namespace modcal::transfer_test
