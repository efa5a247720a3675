#include "libinverse/joint/string_transfer.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <tuple>

namespace modcal {
namespace {

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

}  // namespace
}  // namespace modcal
