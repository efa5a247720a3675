#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libcalib/parameters/parameter_options.hpp"
#include "libsim/base/error.hpp"
#include "tests/libcalib/calibration_case.hpp"

namespace modcal::parameters_test {
namespace {

using Names = std::vector<std::string>;

TEST(ParameterSet, BindsEveryParameterToTheModel) {
  const ModelPoint initial = with_frequency_errors(paper_truth(8), 0.02, 1);
  const ParameterSet set(initial, Names{"x_c", "f_3"});
  EXPECT_EQ(set.start(), (std::vector<double>{0.03, initial.basis.frequency(2)}));
  const ModelPoint model = set.model(std::vector<double>{0.031, 600.0});
  EXPECT_EQ(model.contact, 0.031);
  EXPECT_DOUBLE_EQ(model.basis.frequency(2), 600.0);
  EXPECT_EQ(model.basis.omega[3], initial.basis.omega[3]);
}

TEST(ParameterSet, ModesWithoutAFrequencyOfTheirOwnFollowAFreeLaw) {
  const ParameterSet set(paper_truth(8, 1e-4), Names{"f_3", "f0", "B"});
  EXPECT_NEAR(set[1].variable.initial, 196.0, 1e-9);
  EXPECT_NEAR(set[2].variable.initial, 1e-4, 1e-12);
  const ModelPoint model = set.model(std::vector<double>{590.0, 200.0, 2e-4});
  EXPECT_DOUBLE_EQ(model.basis.frequency(2), 590.0);
  EXPECT_DOUBLE_EQ(model.basis.frequency(7), 8 * 200.0 * std::sqrt(1.0 + 2e-4 * 64));
}

TEST(ParameterSet, FrequencySlopesAreThoseOfTheModel) {
  const ParameterSet set(paper_truth(8, 1e-4), Names{"f_3", "f0", "B", "x_c"});
  const std::vector<double> x = {590.0, 197.0, 2e-4, 0.03};
  for (std::size_t i = 0; i < x.size(); ++i) {
    const double step = 1e-6 * x[i];
    std::vector<double> above = x, below = x;
    above[i] += step;
    below[i] -= step;
    const ModalBasis high = set.model(above).basis;
    const ModalBasis low = set.model(below).basis;
    std::vector<double> slopes(8, 0.0);
    for (const auto& [mode, slope] : set.frequency_slopes(x, i)) slopes[mode] = slope;
    for (std::size_t n = 0; n < 8; ++n) {
      // Rounding of ω (1e-16 ω) over the step; the third derivative adds less.
      const double expected = (high.omega[n] - low.omega[n]) / (2.0 * step);
      EXPECT_NEAR(slopes[n], expected, 1e-15 * high.omega[n] / step + 1e-9 * std::abs(expected));
    }
  }
}

TEST(ParameterSet, DampingAndSensorsAreThoseOfTheModel) {
  ModelPoint initial = paper_truth(8);
  initial.basis.zeta[4] = 2e-3;
  const ParameterSet set(initial,
                         Names{"damping", "damping_power", "zeta_3", "gain", "delay", "corner"});
  EXPECT_EQ(set.start(), (std::vector<double>{1.0, 0.0, initial.basis.zeta[2], 1.0, 0.0, 0.0}));
  EXPECT_EQ(set.model(set.start()).basis.zeta, initial.basis.zeta);
  EXPECT_TRUE(set.model(set.start()).sensors.alike());
  const std::vector<double> x = {1.2, 0.3, 4e-3, 1.02, 2e-6, 4.0};
  const ModelPoint model = set.model(x);
  EXPECT_DOUBLE_EQ(model.basis.zeta[4], 2e-3 * 1.2 * std::pow(5.0, 0.3));
  EXPECT_EQ(model.basis.zeta[2], 4e-3);
  EXPECT_EQ(model.basis.omega, initial.basis.omega);
  EXPECT_EQ(model.sensors.gain, 1.02);
  EXPECT_EQ(model.sensors.delay, 2e-6);
  EXPECT_DOUBLE_EQ(model.sensors.corner, 8.0 * M_PI);
  EXPECT_EQ(set[5].variable.unit, "Hz");
  for (std::size_t i = 0; i < x.size(); ++i) {
    EXPECT_TRUE(set.frequency_slopes(x, i).empty());
    std::vector<double> above = x, below = x;
    const double step = 1e-6 * x[i];
    above[i] += step;
    below[i] -= step;
    std::vector<double> slopes(8, 0.0);
    for (const auto& [mode, slope] : set.damping_slopes(x, i)) slopes[mode] = slope;
    for (std::size_t n = 0; n < 8; ++n) {
      // Rounding of ζ (1e-16 ζ) over the step; the third derivative adds less.
      const double expected =
          (set.model(above).basis.zeta[n] - set.model(below).basis.zeta[n]) / (2.0 * step);
      EXPECT_NEAR(slopes[n], expected, 1e-15 * model.basis.zeta[n] / step + 1e-9 * expected);
    }
  }
}

TEST(ParameterSet, BoundsHoldTheInitialValuesAndKeepTheContactInsideTheString) {
  const ParameterSet set(paper_truth(8, 0.0, 0.002), Names{"f_1", "f0", "B", "x_c"});
  for (const Variable& variable : set.variables()) {
    EXPECT_LE(variable.lower, variable.initial) << variable.name;
    EXPECT_LT(variable.initial, variable.upper) << variable.name;
    EXPECT_GT(variable.scale, 0.0);
  }
  EXPECT_GT(set[3].variable.lower, 0.0);
  EXPECT_EQ(set[3].variable.unit, "m");
  EXPECT_DOUBLE_EQ(set[0].variable.upper, 196.0 * 1.04);
}

TEST(ParameterSet, LetsInharmonicityFallBelowZeroAsFarAsTheLawOfTheHighestModeAllows) {
  const auto lower = [](double inharmonicity, const ParameterRanges& ranges) {
    return ParameterSet(paper_truth(8, inharmonicity), Names{"f0", "B"}, ranges)[1].variable.lower;
  };
  // 1 + B n² = 0 at −1/64: half of it.
  EXPECT_DOUBLE_EQ(lower(0.0, {.inharmonicity = 0.1}), -0.5 / 64.0);
  EXPECT_NEAR(lower(0.0, {.inharmonicity = 1e-3}), -1e-3, 1e-12);
  EXPECT_NEAR(lower(4e-4, {.inharmonicity = 1e-3}), -6e-4, 1e-12);
  EXPECT_EQ(lower(4e-4, {.inharmonicity = 1e-3, .lowest_inharmonicity = 0.0}), 0.0);
  EXPECT_THROW(lower(0.0, {.lowest_inharmonicity = -1.0 / 64.0}), InvalidInput);
  EXPECT_THROW(lower(0.0, {.lowest_inharmonicity = 1e-4}), InvalidInput);
  // A law that starts below 0 is kept, and every frequency at the bound is one.
  ModelPoint soft = paper_truth(8);
  for (std::size_t n = 0; n < 8; ++n) {
    const auto order = static_cast<double>(n + 1);
    soft.basis.omega[n] *= std::sqrt(1.0 - 1e-3 * order * order);
  }
  const ParameterSet set(soft, Names{"f0", "B"}, {.inharmonicity = 0.1});
  EXPECT_NEAR(set[1].variable.initial, -1e-3, 1e-9);
  const ModelPoint lowest = set.model(std::vector<double>{196.0, set[1].variable.lower});
  EXPECT_NEAR(lowest.basis.frequency(7), 8 * 196.0 * std::sqrt(0.5), 1e-9);
}

TEST(ParameterSet, RefusesWrongNamesAndRanges) {
  const ModelPoint truth = paper_truth(8);
  for (const Names& names : {Names{}, Names{"f_9"}, Names{"f_0"}, Names{"f_"}, Names{"f_1x"},
                             Names{"g"}, Names{"x_c", "x_c"}}) {
    EXPECT_THROW(ParameterSet(truth, names), InvalidInput) << testing::PrintToString(names);
  }
  EXPECT_THROW(ParameterSet(truth, Names{"f_1"}, {.frequency = 0.0}), InvalidInput);
  ParameterRanges ranges;
  ranges.sensors[Sensor::kGain] = 1.0;
  EXPECT_THROW(ParameterSet(truth, Names{"gain"}, ranges), InvalidInput);
  ranges = {};
  ranges.sensors[Sensor::kDelay] = 0.0;
  EXPECT_THROW(ParameterSet(truth, Names{"delay"}, ranges), InvalidInput);
  EXPECT_THROW(ParameterSet(truth, Names{"zeta_9"}), InvalidInput);
  EXPECT_THROW(ParameterSet(truth, Names{"x_c 2"}), InvalidInput);
  EXPECT_THROW(ParameterSet(paper_truth(8, 0.0, 0.33), Names{"f_1"}), InvalidInput);
  EXPECT_THROW(ParameterSet({truth.basis, std::nan("")}, Names{"f_1"}), InvalidInput);
}

TEST(ParameterOptions, NameWhatIsFree) {
  ParameterOptions options{.frequencies = "all", .contact = true};
  EXPECT_EQ(options.names(2), (Names{"f_1", "f_2", "x_c"}));
  options = {.frequencies = "listed", .modes = {5, 3}, .law = true};
  EXPECT_EQ(options.names(8), (Names{"f_5", "f_3", "f0", "B"}));
  options = {.contact = true, .unknowns = {.damping = "power"}};
  options.unknowns.sensor[Sensor::kGain].free = true;
  options.unknowns.sensor[Sensor::kDelay].free = true;
  EXPECT_EQ(options.names(8), (Names{"x_c", "damping", "damping_power", "gain", "delay"}));
  options = {.unknowns = {.damping = "each"}};
  EXPECT_EQ(options.names(2), (Names{"zeta_1", "zeta_2"}));
  EXPECT_THROW(ParameterOptions{}.names(8), InvalidInput);
  options = {.frequencies = "all", .modes = {5}};
  EXPECT_THROW(options.names(8), InvalidInput);
  options = {.frequencies = "listed"};
  EXPECT_THROW(options.names(8), InvalidInput);
}

}  // namespace
}  // namespace modcal::parameters_test
