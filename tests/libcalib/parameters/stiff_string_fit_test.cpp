#include "libcalib/parameters/stiff_string_fit.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "libsim/base/error.hpp"
#include "libsim/base/random.hpp"
#include "libsim/model/string_model.hpp"

namespace modcal::stiff_string_fit_test {
namespace {

std::vector<double> law(double fundamental, double inharmonicity, std::size_t modes) {
  std::vector<double> frequencies;
  for (std::size_t n = 1; n <= modes; ++n) {
    frequencies.push_back(stiff_string_frequency(fundamental, inharmonicity, n));
  }
  return frequencies;
}

TEST(StiffStringFit, IsExactOnTheLaw) {
  for (const double inharmonicity : {0.0, 1.39e-4, 1e-2}) {
    const StiffStringFit fit = fit_stiff_string(law(196.0, inharmonicity, 55));
    EXPECT_TRUE(fit.converged);
    EXPECT_NEAR(fit.fundamental, 196.0, 196.0 * 1e-13);
    EXPECT_NEAR(fit.inharmonicity, inharmonicity, 1e-13 * (1.0 + inharmonicity));
    EXPECT_LT(fit.rms_residual, 1e-8);
  }
}

TEST(StiffStringFit, DoesNotLookAtModesWithoutWeight) {
  std::vector<double> frequencies = law(196.0, 1.4e-4, 30);
  std::vector<double> weights(30, 2.0);
  for (const std::size_t blind : {10, 21}) {
    frequencies[blind] = std::numeric_limits<double>::quiet_NaN();
    weights[blind] = 0.0;
  }
  const StiffStringFit fit = fit_stiff_string(frequencies, weights);
  EXPECT_EQ(fit.modes, 28u);
  EXPECT_NEAR(fit.inharmonicity, 1.4e-4, 1e-13);
  std::vector<bool> excited(30, true);
  excited[10] = excited[21] = false;
  const auto filled = fill_unexcited_modes(frequencies, excited, fit);
  EXPECT_NEAR(filled[10], stiff_string_frequency(196.0, 1.4e-4, 11), 1e-9);
  EXPECT_EQ(filled[11], frequencies[11]);
}

// At a least-squares minimum the weighted residual is orthogonal to both slopes of the law.
TEST(StiffStringFit, MinimizesTheResidualInHertzNotThatOfTheLinearStart) {
  std::vector<double> frequencies = law(196.0, 1.4e-4, 40);
  std::vector<double> noise(40), weights(40);
  fill_standard_normal(StreamKey(5), noise);
  for (std::size_t i = 0; i < 40; ++i) {
    frequencies[i] *= 1.0 + 0.01 * noise[i];
    weights[i] = 1.0 / static_cast<double>(i + 1);
  }
  const StiffStringFit fit = fit_stiff_string(frequencies, weights);
  EXPECT_TRUE(fit.converged);
  double by_fundamental = 0.0, by_inharmonicity = 0.0, scale_f = 0.0, scale_b = 0.0;
  for (std::size_t i = 0; i < 40; ++i) {
    const double n = static_cast<double>(i + 1);
    const double root = std::sqrt(1.0 + fit.inharmonicity * n * n);
    const double residual = weights[i] * (frequencies[i] - fit.frequency(i + 1));
    by_fundamental += residual * n * root;
    scale_f += std::abs(residual * n * root);
    by_inharmonicity += residual * n * n * n / root;
    scale_b += std::abs(residual * n * n * n / root);
  }
  // The last step is below 1e-13 of the unknowns, or rounding of the cost (1e-16) hides steps of
  // its root, 1e-8, times the conditioning of the two slopes, about 10.
  EXPECT_LT(std::abs(by_fundamental), 1e-6 * scale_f);
  EXPECT_LT(std::abs(by_inharmonicity), 1e-6 * scale_b);
}

TEST(StiffStringFit, StandardDeviationsCoverTheTruth) {
  int covered = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    std::vector<double> frequencies = law(196.0, 1.4e-4, 40);
    std::vector<double> noise(40);
    fill_standard_normal(StreamKey(seed), noise);
    for (std::size_t i = 0; i < 40; ++i) frequencies[i] += 2.0 * noise[i];
    const StiffStringFit fit = fit_stiff_string(frequencies);
    covered += std::abs(fit.inharmonicity - 1.4e-4) < fit.inharmonicity_deviation;
  }
  // 68 % of 200 within one deviation: 136 ± 6.6; four of these to either side.
  EXPECT_NEAR(covered, 136, 27);
}

TEST(StiffStringFit, RefusesWhatHasNoLaw) {
  EXPECT_THROW(fit_stiff_string(std::vector<double>{196.0}), InvalidInput);
  EXPECT_THROW(fit_stiff_string(std::vector<double>{196.0, -1.0}), InvalidInput);
  EXPECT_THROW(fit_stiff_string(std::vector<double>{1.0, 100.0, 1000.0}), InvalidInput);
  EXPECT_THROW(fit_stiff_string(std::vector<double>{1.0, 2.0}, std::vector<double>{1.0}),
               InvalidInput);
  EXPECT_THROW(fit_stiff_string(std::vector<double>{1.0, 2.0}, std::vector<double>{1.0, -1.0}),
               InvalidInput);
}

TEST(InharmonicityText, NearZeroIsZeroOrHasItsDeviation) {
  EXPECT_EQ(inharmonicity_text(-7.778e-20), "0");
  EXPECT_EQ(inharmonicity_text(-7.778e-20, 1e-19), "0");
  EXPECT_EQ(inharmonicity_text(2.4695622e-9, 5.77e-9), "2.47e-09 (sd 5.8e-09)");
  EXPECT_EQ(inharmonicity_text(1.4e-4, 1e-6), "0.00014");
  EXPECT_EQ(inharmonicity_text(1.4e-4), "0.00014");
}

}  // namespace
}  // namespace modcal::stiff_string_fit_test
