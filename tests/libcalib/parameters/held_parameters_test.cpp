// Parameters that are known exactly, in fits to synthetic truth.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libcalib/calibration.hpp"
#include "libcalib/parameters/stated_priors.hpp"
#include "libsim/base/error.hpp"
#include "tests/libcalib/likelihood/bowed_case.hpp"
#include "tests/libcalib/optimizers/staged/as_calibration.hpp"

namespace modcal::held_parameters_test {
namespace {

constexpr double kInharmonicity = 1.39e-4;

class HeldParameters : public testing::Test {
 protected:
  BowedCase bowed = bowed_case(0.0285, kInharmonicity, 0.5);
  NoisyRecords records = noisy(bowed, 0.01, 12);
  CalibrationData data =
      CalibrationData::of_records(records.reactions[0], records.reactions[1], records.sample_rate);

  ModelPoint start() const {
    ModelPoint point = bowed.truth;
    for (double& omega : point.basis.omega) omega *= 1.004;
    point.contact += 5e-4;
    return point;
  }
  ContinuationOptions options(std::vector<FixedParameter> fixed) const {
    ContinuationOptions result{.law_width = 2e-3,
                               .left_noise = records.deviation[0],
                               .right_noise = records.deviation[1],
                               .restarts = 0};
    result.unknowns.fixed = std::move(fixed);
    return result;
  }
  ContinuationResult fit(std::vector<FixedParameter> fixed, bool frequencies = true) const {
    ContinuationOptions with = options(std::move(fixed));
    with.frequencies = frequencies;
    return calibrate_by_continuation(start(), data, with);
  }
};

TEST_F(HeldParameters, OfTheLawComeBackBitForBit) {
  const ContinuationResult free = fit({}, false);
  for (const bool frequencies : {false, true}) {
    const ContinuationResult held =
        fit({{"f0", 196.0}, {"B", kInharmonicity}, {"x_c", 0.0285}}, frequencies);
    EXPECT_TRUE(held.right) << held.chi2;
    EXPECT_EQ(held.law.fundamental, 196.0);
    EXPECT_EQ(held.law.inharmonicity, kInharmonicity);
    EXPECT_EQ(held.model.contact, 0.0285);
    EXPECT_EQ(held.contact_deviation, 0.0);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(held.law.deviation[i], 0.0);
    EXPECT_GT(held.law.deviation[3], 0.0);
    EXPECT_LT(std::abs(held.law.damping - 1.0), 6.0 * held.law.deviation[3]);
    // Knowing the rest exactly cannot hurt.
    EXPECT_LT(held.law.deviation[3], 1.01 * free.law.deviation[3]);
  }
}

TEST_F(HeldParameters, OneOfTheLawHelpsTheOthers) {
  const ContinuationResult free = fit({}, false);
  const ContinuationResult held = fit({{"B", kInharmonicity}}, false);
  EXPECT_EQ(held.law.inharmonicity, kInharmonicity);
  EXPECT_EQ(held.law.deviation[1], 0.0);
  EXPECT_LT(held.law.deviation[0], 0.95 * free.law.deviation[0]);
  EXPECT_LT(std::abs(held.law.fundamental - 196.0), 6.0 * held.law.deviation[0]);
  EXPECT_LT(std::abs(held.law.contact - 0.0285), 6.0 * held.law.deviation[2]);
}

TEST_F(HeldParameters, SingleModesKeepFrequencyAndDamping) {
  const double third = bowed.truth.basis.frequency(2);
  ModelPoint initial = start();
  initial.basis.omega[6] = bowed.truth.basis.omega[6];
  ContinuationOptions with = options({{"f_3", third}, {"f_7"}, {"zeta_5", 1.001e-3}});
  with.unknowns.damping = "each";
  const ContinuationResult held = calibrate_by_continuation(initial, data, with);
  EXPECT_TRUE(held.right) << held.chi2;
  EXPECT_EQ(held.model.basis.omega[2], 2.0 * std::numbers::pi * third);
  EXPECT_EQ(held.model.basis.omega[6], initial.basis.omega[6]);
  EXPECT_EQ(held.model.basis.zeta[4], 1.001e-3);
  for (const std::size_t n : {3u, 7u}) {
    EXPECT_EQ(held.modes[n - 1].source, ModeSource::kFixed);
    EXPECT_EQ(held.modes[n - 1].deviation, 0.0);
  }
  for (const ModeVerdict& mode : held.modes) {
    if (mode.source != ModeSource::kIdentified) continue;
    const auto n = static_cast<std::size_t>(&mode - held.modes.data());
    EXPECT_LT(std::abs(mode.frequency / bowed.truth.basis.frequency(n) - 1.0), 6.0 * mode.deviation)
        << n + 1;
  }
  const ContinuationResult law = fit({{"f_3", third}}, false);
  EXPECT_EQ(law.model.basis.omega[2], 2.0 * std::numbers::pi * third);
  EXPECT_EQ(law.modes[2].source, ModeSource::kFixed);
}

TEST_F(HeldParameters, AWrongValueIsContradicted) {
  EXPECT_FALSE(fit({{"x_c", 0.0288}}, false).right);
  EXPECT_FALSE(fit({{"f_3", 1.003 * bowed.truth.basis.frequency(2)}}, false).right);
}

TEST_F(HeldParameters, ContactsOfFurtherStrokesAreHeldEach) {
  const BowedCase second = bowed_case(0.0291, kInharmonicity, 0.5);
  BowedCase scaled = second;
  scaled.spread = bowed.spread;
  const NoisyRecords more = noisy(scaled, 0.01, 13);
  const std::vector<CalibrationData> strokes = {
      data, CalibrationData::of_records(more.reactions[0], more.reactions[1], more.sample_rate)};
  ContinuationOptions with = options({{"x_c 2", 0.0291}});
  const ContinuationResult fit = calibrate_records(start(), strokes, with);
  EXPECT_TRUE(fit.right) << fit.chi2;
  EXPECT_EQ(fit.contacts[1], 0.0291);
  EXPECT_EQ(fit.contact_deviations[1], 0.0);
  EXPECT_GT(fit.contact_deviations[0], 0.0);
  EXPECT_LT(std::abs(fit.contacts[0] - 0.0285), 6.0 * fit.contact_deviations[0]);
  with = options({{"x_c", 0.0285}, {"f0", 196.0}});
  with.frequencies = false;
  const ContinuationResult first = calibrate_records(start(), strokes, with);
  EXPECT_EQ(first.contacts[0], 0.0285);
  EXPECT_EQ(first.law.fundamental, 196.0);
  EXPECT_EQ(first.law.deviation[0], 0.0);
  EXPECT_GT(first.contact_deviations[1], 0.0);
  EXPECT_LT(std::abs(first.contacts[1] - 0.0291), 6.0 * first.contact_deviations[1]);
}

TEST_F(HeldParameters, AreWhatACalibrationWithoutAFreeContactHolds) {
  CalibrationOptions with = as_calibration(options({}));
  with.parameters.frequencies = "none";
  with.parameters.contact = false;
  ModelPoint initial = start();
  initial.contact = 0.0285;
  const CalibrationResult result = calibrate(initial, data, with);
  EXPECT_EQ(result.model.contact, 0.0285);
  EXPECT_EQ(result.continuation->contact_deviations, std::vector<double>{0.0});
  EXPECT_THROW(calibrate(initial, as_records({data, data}), with), InvalidInput);
}

TEST(FixedParameters, ThatCannotBeAreRefusedWithTheReason) {
  const auto refused = [](std::vector<FixedParameter> fixed, const std::string& reason,
                          std::vector<ParameterPrior> priors = {}) {
    UnknownsOptions options;
    options.fixed = std::move(fixed);
    options.priors = std::move(priors);
    try {
      require_priors(options, 3, 2);
      ADD_FAILURE() << "accepted, not refused for " << reason;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
    }
  };
  refused({{"f_4", 784.0}}, "unknown parameter \"f_4\"");
  refused({{"f_3"}, {"f_3", 588.0}}, "fixed twice");
  refused({{"x_c 3", 0.03}}, "there are 2 records");
  refused({{"B 2", 0.0}}, "all records share it");
  refused({{"f0", -196.0}}, "must be > 0");
  refused({{"zeta_1", 1.0}}, "rings below 1");
  refused({{"damping", 1.0}}, "damping: fixed");
  refused({{"damping_power", 1.0}}, "damping: factor");
  refused({{"gain", 1.0}}, "leave it out of the sensors");
  refused({{"f_1"}, {"f_2"}}, "no two modes left");
  refused({{"f0", 196.0}}, "state one of the two", {{"f0", 196.0, 1.0}});
  refused({{"zeta_1", 1e-3}}, "zeta_1 is fixed", {{"damping", 1.0, 0.1}});
  UnknownsOptions all;
  all.fixed = {{"f_1"}, {"f_2"}, {"f_3"}, {"f0"}, {"B"}};
  EXPECT_NO_THROW(require_priors(all, 3));
  // Beside what acts through the first ratios any other parameter may be fixed.
  UnknownsOptions beside;
  beside.damping = "power";
  beside.fixed = {{"f_1"}, {"x_c", 0.03}, {"zeta_3", 1e-3}};
  beside.priors = {{"damping", 1.0, 0.1}, {"damping_power", 0.0, 0.1}};
  EXPECT_NO_THROW(require_priors(beside, 5));
}

}  // namespace
}  // namespace modcal::held_parameters_test
