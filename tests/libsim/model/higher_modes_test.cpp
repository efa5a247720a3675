#include "libsim/model/higher_modes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "libsim/model/string_model.hpp"
#include "libsim/model/tuning.hpp"

namespace modcal::higher_modes_test {
namespace {

using std::numbers::pi;

struct Case {
  double inharmonicity, place, share;  // B, x_c/L, the band's end of the highest mode
  std::int64_t modes;
  bool bending;
};

ModalBasis basis_of(double inharmonicity, std::int64_t modes) {
  return make_modal_basis({.length = 0.33,
                           .linear_density = 1e-3,
                           .fundamental = 294.0,
                           .inharmonicity = inharmonicity,
                           .modes = modes});
}

// Odd and even sums at s = iω.
std::array<double, 2> sums_of(const std::vector<HigherMode>& modes, double omega) {
  std::array<double, 2> sums{};
  for (const HigherMode& mode : modes) {
    sums[mode.even ? 1 : 0] += mode.residue / (mode.omega * mode.omega - omega * omega);
  }
  return sums;
}

// The same mode by mode, up to where the static rest is added in closed form: with 40 000 modes
// what the rest lacks, (f/f_n)² of 1/40 000, is below 1e-11.
std::array<double, 2> brute_sums(const Case& the, double omega) {
  std::array<double, 2> sums{};
  const ModalBasis basis = basis_of(the.inharmonicity, the.modes);
  constexpr std::size_t kMany = 40000;
  const double unit = 2.0 * pi * 294.0;
  std::array<double, 2> fixed{};
  for (std::size_t n = 1; n <= kMany; ++n) {
    const double number = static_cast<double>(n);
    const double stiff = 1.0 + the.inharmonicity * number * number;
    const double static_term =
        2.0 / pi * sine_shape(n, the.place) / number / (the.bending ? 1.0 : stiff);
    const double ratio = omega * omega / (unit * unit * number * number * stiff);
    fixed[n % 2 == 0 ? 1 : 0] += static_term;
    if (n > static_cast<std::size_t>(the.modes)) {
      sums[n % 2 == 0 ? 1 : 0] += static_term / (1.0 - ratio);
    }
  }
  // Static response of the whole string: (1 − ξ) and ξ, less the bending's share.
  const double beta = the.inharmonicity > 0.0 ? pi / std::sqrt(the.inharmonicity) : 0.0;
  const auto whole = [&](double place) {
    if (the.bending || beta == 0.0) return 1.0 - place;
    return 1.0 - place -
           (std::exp(-beta * place) - std::exp(-beta * (2.0 - place))) /
               (1.0 - std::exp(-2.0 * beta));
  };
  const double left = whole(the.place), right = whole(1.0 - the.place);
  sums[0] += 0.5 * (left + right) - fixed[0];
  sums[1] += 0.5 * (left - right) - fixed[1];
  return sums;
}

class HigherModes : public testing::TestWithParam<Case> {};
/// Without inharmonicity one side alone has a derivative with respect to it.
class StiffHigherModes : public testing::TestWithParam<Case> {};

TEST_P(HigherModes, AnswerAsAllOfThemDo) {
  const Case& the = GetParam();
  const ModalBasis basis = basis_of(the.inharmonicity, the.modes);
  const double highest = the.share * basis.frequency(basis.size() - 1);
  const HigherModeLaw law =
      HigherModeLaw::above(basis, 294.0, the.inharmonicity, highest, the.bending);
  const std::vector<HigherMode> modes = higher_modes(law, basis, the.place * 0.33);
  ASSERT_EQ(modes.size(), higher_mode_count(law));
  for (int i = 0; i <= 20; ++i) {
    const double omega = 2.0 * pi * highest * i / 20.0;
    const auto found = sums_of(modes, omega), expected = brute_sums(the, omega);
    // |H| of a static force is of the order of 1; what the interpolation and the sums leave (see
    // the source) is (f/f0)²/1500³ · 2/π/(2 sin(θ/2)) ≤ 5e-6 at f = 60 f0, θ = π/12.
    EXPECT_NEAR(found[0], expected[0], 5e-6) << omega;
    EXPECT_NEAR(found[1], expected[1], 5e-6) << omega;
  }
}

TEST_P(StiffHigherModes, HaveDerivatives) {
  const Case& the = GetParam();
  const ModalBasis basis = basis_of(the.inharmonicity, the.modes);
  const double highest = the.share * basis.frequency(basis.size() - 1);
  const HigherModeLaw law =
      HigherModeLaw::above(basis, 294.0, the.inharmonicity, highest, the.bending);
  const double contact = the.place * 0.33, omega = 2.0 * pi * 0.7 * highest;
  const auto at = [&](double x, double b) {
    HigherModeLaw other = law;
    other.inharmonicity = b;
    return sums_of(higher_modes(other, basis, x), omega);
  };
  double by_contact = 0.0, by_b = 0.0;
  for (const HigherMode& mode : higher_modes(law, basis, contact)) {
    if (mode.even) continue;
    const double inverse = 1.0 / (mode.omega * mode.omega - omega * omega);
    by_contact += mode.by_contact * inverse;
    by_b += mode.by_inharmonicity * inverse;
    const double n = static_cast<double>(mode.number);
    if (mode.number == 0) continue;
    const double share = 0.5 * n * n / (1.0 + the.inharmonicity * n * n);
    by_b -= mode.residue * inverse * inverse * 2.0 * mode.omega * mode.omega * share;
  }
  const double dx = 1e-6, db = 1e-3 * the.inharmonicity;
  const double x_slope =
      (at(contact + dx, the.inharmonicity)[0] - at(contact - dx, the.inharmonicity)[0]) / (2 * dx);
  const double b_slope =
      (at(contact, the.inharmonicity + db)[0] - at(contact, the.inharmonicity - db)[0]) / (2 * db);
  // Central differences: third derivatives over their steps.
  EXPECT_NEAR(by_contact, x_slope, 1e-4 * std::abs(x_slope) + 1e-4);
  EXPECT_NEAR(by_b, b_slope, 1e-4 * std::abs(b_slope) + 1e-4);
}

// The interpolation's pole has to lie outside its interval by so much; modes below that are apart.
TEST(HigherModeLaw, LetsNoMoreModesStandForThemselvesThanTheInterpolationNeeds) {
  for (const double highest : {9000.0, 12000.0, 20000.0}) {
    const HigherModeLaw law = HigherModeLaw::above(basis_of(0.0, 30), 294.0, 0.0, highest);
    const auto square = [&](std::size_t n) {
      return std::pow(294.0 * static_cast<double>(n) / highest, 2);
    };
    EXPECT_GE(square(law.apart), kRemainderApart) << highest;
    EXPECT_LT(square(law.apart - 1), kRemainderApart) << highest;
  }
}

// Without bending what one side alone has to its inharmonicity is left out; the contact's stays.
TEST(LimpHigherModes, HaveADerivativeWithRespectToTheContact) {
  const ModalBasis basis = basis_of(0.0, 30);
  const double highest = basis.frequency(basis.size() - 1), contact = 0.03, dx = 1e-6;
  const HigherModeLaw law = HigherModeLaw::above(basis, 294.0, 0.0, highest, false);
  const auto modes = higher_modes(law, basis, contact);
  const auto before = higher_modes(law, basis, contact - dx);
  const auto behind = higher_modes(law, basis, contact + dx);
  ASSERT_FALSE(modes.empty());
  for (std::size_t n = 0; n < modes.size(); ++n) {
    const double slope = (behind[n].residue - before[n].residue) / (2 * dx);
    // (n π dx/L)²/6 of the number n = 60 of them, 5e-8, and rounding over dx.
    EXPECT_NEAR(modes[n].by_contact, slope,
                1e-5 * std::abs(slope) + 1e-9 * std::abs(modes[n].residue) / dx)
        << n;
  }
}

const auto kStiff =
    testing::Values(Case{1.1e-4, 0.125, 0.98, 40, false}, Case{1.1e-4, 0.125, 0.98, 40, true},
                    Case{1.1e-4, 0.125, 0.5, 60, false}, Case{2e-6, 0.2, 1.0, 50, false},
                    Case{1e-3, 0.31, 0.9, 20, false});
INSTANTIATE_TEST_SUITE_P(Strings, HigherModes, kStiff);
INSTANTIATE_TEST_SUITE_P(Limp, HigherModes, testing::Values(Case{0.0, 0.091, 1.0, 30, false}));
INSTANTIATE_TEST_SUITE_P(Strings, StiffHigherModes, kStiff);

}  // namespace
}  // namespace modcal::higher_modes_test
