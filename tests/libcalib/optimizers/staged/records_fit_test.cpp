#include <gtest/gtest.h>

#include <cmath>

#include "libcalib/calibration.hpp"
#include "libcalib/optimizers/staged/continuation.hpp"
#include "libsim/base/error.hpp"
#include "tests/libcalib/likelihood/bowed_case.hpp"
#include "tests/libcalib/likelihood/pluck_record_case.hpp"
#include "tests/libcalib/optimizers/staged/as_calibration.hpp"

namespace modcal::records_fit_test {
namespace {

constexpr double kInharmonicity = 1.39e-4;

struct Strokes {
  ModelPoint start;
  std::vector<CalibrationData> data;
  ContinuationOptions options;
};

// Strokes at the contacts, half a second each, equal noise in all of them.
Strokes strokes(const std::vector<double>& contacts) {
  Strokes result;
  for (std::size_t r = 0; r < contacts.size(); ++r) {
    const BowedCase bowed = bowed_case(contacts[r], kInharmonicity, 0.5);
    if (r == 0) {
      result.start = bowed.truth;
      result.options = {.law_width = 2e-3,
                        .left_noise = 0.02 * bowed.spread[0],
                        .right_noise = 0.02 * bowed.spread[1],
                        .restarts = 0};
    }
    BowedCase scaled = bowed;
    scaled.spread = {50.0 * result.options.left_noise, 50.0 * result.options.right_noise};
    const NoisyRecords records = noisy(scaled, 0.02, 40 + r);
    result.data.push_back(CalibrationData::of_records(records.reactions[0], records.reactions[1],
                                                      records.sample_rate));
  }
  for (double& omega : result.start.basis.omega) omega *= 1.004;
  return result;
}

TEST(RecordsFit, FourStrokesHalveTheDeviationsAndKeepTheirContacts) {
  const std::vector<double> contacts = {0.0285, 0.0285, 0.0291, 0.0291};
  Strokes four = strokes(contacts);
  four.options.frequencies = false;
  const ContinuationResult fit = calibrate_records(four.start, four.data, four.options);
  EXPECT_TRUE(fit.right) << fit.chi2;
  EXPECT_LT(std::abs(fit.law.fundamental - 196.0), 6.0 * fit.law.deviation[0]);
  EXPECT_LT(std::abs(fit.law.inharmonicity - kInharmonicity), 6.0 * fit.law.deviation[1]);
  double information = 0.0;
  for (std::size_t r = 0; r < contacts.size(); ++r) {
    EXPECT_LT(std::abs(fit.contacts[r] - contacts[r]), 6.0 * fit.contact_deviations[r]) << r;
    information += std::pow(fit.single[r].law.deviation[0], -2);
  }
  EXPECT_TRUE(fit.law.accepted);
  EXPECT_EQ(fit.law.chi2, fit.chi2);
  const ContinuationResult as_one = fit;
  for (std::size_t n = 0; n < 50; ++n) {
    const ModeVerdict& mode = as_one.modes[n];
    EXPECT_EQ(mode.frequency, fit.model.basis.frequency(n));
    EXPECT_EQ(mode.source, ModeSource::kLaw);
    EXPECT_LT(mode.deviation, 0.65 * fit.single[0].modes[n].deviation) << n + 1;
  }
  // Informations add; that of f0 alone knows of x_c and the rest, which are the records' own but
  // for the damping: a few percent. Noise in JᵀJ and weights are another.
  EXPECT_NEAR(fit.law.deviation[0] * std::sqrt(information), 1.0, 0.1);
  EXPECT_LT(fit.law.deviation[0], 0.65 * fit.single[0].law.deviation[0]);
}

TEST(RecordsFit, EveryFrequencyProfits) {
  const Strokes two = strokes({0.0285, 0.0285});
  const ContinuationResult fit = calibrate_records(two.start, two.data, two.options);
  EXPECT_TRUE(fit.right) << fit.chi2;
  ASSERT_EQ(fit.frequency_deviations.size(), 50u);
  // The law is that of both, not of one.
  const LawEstimate law = fit.law;
  EXPECT_TRUE(law.accepted) << law.chi2;
  EXPECT_NE(law.chi2, fit.single[0].law.chi2);
  EXPECT_NEAR(law.deviation[0] / fit.single[0].law.deviation[0], std::sqrt(0.5), 0.1);
  EXPECT_LT(std::abs(law.fundamental - 196.0), 6.0 * law.deviation[0]);
  EXPECT_LT(std::abs(law.inharmonicity - kInharmonicity), 6.0 * law.deviation[1]);
  const ModelPoint truth = bowed_case(0.0285, kInharmonicity, 0.02).truth;
  double square = 0.0, count = 0.0;
  for (std::size_t n = 0; n < 50; ++n) {
    const ModeVerdict& alone = fit.single[0].modes[n];
    if (alone.source != ModeSource::kIdentified || alone.deviation > 3e-4) continue;
    EXPECT_NEAR(fit.frequency_deviations[n] / alone.deviation, std::sqrt(0.5), 0.15) << n + 1;
    const double error = fit.model.basis.omega[n] / truth.basis.omega[n] - 1.0;
    square += std::pow(error / fit.frequency_deviations[n], 2);
    count += 1.0;
  }
  EXPECT_GT(count, 10.0);
  // Mean of squares of unit variance: sd √(2/count), five of them.
  EXPECT_LT(square / count, 1.0 + 5.0 * std::sqrt(2.0 / count));
}

TEST(RecordsFit, IsACalibrationWithAContactForEveryStroke) {
  const std::vector<double> contacts = {0.0285, 0.0291};
  const Strokes two = strokes(contacts);
  CalibrationOptions options = as_calibration(two.options);
  options.parameters.frequencies = "none";
  const CalibrationResult result = calibrate(two.start, as_records(two.data), options);
  const ContinuationResult fit = [&] {
    ContinuationOptions law = two.options;
    law.frequencies = false;
    return calibrate_records(two.start, two.data, law);
  }();
  EXPECT_EQ(result.continuation->contact_deviations, fit.contact_deviations);
  EXPECT_EQ(result.continuation->chi2, fit.chi2);
  EXPECT_EQ(result.continuation->law.deviation[0], fit.law.deviation[0]);
  EXPECT_EQ(result.model.basis.omega, fit.model.basis.omega);
  std::vector<double> found;
  for (const CalibratedParameter& parameter : result.parameters) {
    if (parameter.name.starts_with("x_c")) found.push_back(parameter.final);
  }
  EXPECT_EQ(found, fit.contacts);
  options.optimizer = Choice<Optimizer>("ceres");
  EXPECT_THROW(calibrate(two.start, as_records(two.data), options), InvalidInput);
}

// A stroke at L/11 of the string without stiffness, to which modes 11, 22, 33 and 44 are blind.
Strokes blind_stroke() {
  const BowedCase bowed = bowed_case(0.03, 0.0, 0.5);
  const NoisyRecords records = noisy(bowed, 0.01, 8);
  Strokes result{.start = bowed.truth,
                 .data = {CalibrationData::of_records(records.reactions[0], records.reactions[1],
                                                      records.sample_rate)},
                 .options = {.law_width = 2e-3,
                             .left_noise = records.deviation[0],
                             .right_noise = records.deviation[1],
                             .restarts = 0}};
  for (double& omega : result.start.basis.omega) omega *= 1.004;
  return result;
}

PluckRecord as_record(const NoisyRecords& records) {
  return {.data = CalibrationData::of_records(records.reactions[0], records.reactions[1],
                                              records.sample_rate),
          .noise = records.deviation};
}

void expect_modes(const ContinuationResult& fit, const ModelPoint& truth,
                  const std::vector<std::size_t>& numbers) {
  for (const std::size_t n : numbers) {
    EXPECT_EQ(fit.modes[n - 1].source, ModeSource::kIdentified) << n;
    EXPECT_NE(fit.single[0].modes[n - 1].source, ModeSource::kIdentified) << n;
    const double error = fit.model.basis.omega[n - 1] / truth.basis.omega[n - 1] - 1.0;
    EXPECT_LT(std::abs(error), 6.0 * fit.frequency_deviations[n - 1]) << n;
    EXPECT_LT(fit.frequency_deviations[n - 1], 2e-4) << n;
  }
}

TEST(RecordsFit, APluckSeesTheModesThatTheStrokeDoesNot) {
  const Strokes one = blind_stroke();
  const ModelPoint truth = bowed_case(0.03, 0.0, 0.02).truth;
  const std::vector<PluckRecord> plucks = {as_record(plucked_records(0.0, 0.5, 0.01, 3))};
  const ContinuationResult fit = calibrate_records(one.start, one.data, one.options, plucks);
  EXPECT_TRUE(fit.right) << fit.chi2;
  expect_modes(fit, truth, {11, 22, 33, 44});
  EXPECT_LT(std::abs(fit.model.contact - 0.03), 6.0 * fit.contact_deviations[0]);
  EXPECT_LT(std::abs(fit.values[0].damping - 1.0), 6.0 * fit.values[0].damping_deviation);
  // Informations add: no mode is known worse than by the stroke alone, noise in JᵀJ aside.
  const ContinuationResult alone = calibrate_records(one.start, one.data, one.options);
  for (std::size_t n = 0; n < 50; ++n) {
    EXPECT_LT(fit.frequency_deviations[n], 1.05 * alone.frequency_deviations[n]) << n + 1;
  }
  // Free modes in a node of the contact must not take the bins that tell it: as well known as by
  // the stroke alone, and as with the law's few unknowns.
  EXPECT_LT(fit.contact_deviations[0], 1.05 * alone.contact_deviations[0]);
  EXPECT_LT(fit.contact_deviations[0], 1.05 * fit.law.deviation[2]);
  const ContinuationResult result = fit;
  EXPECT_EQ(result.modes[10].frequency, fit.model.basis.frequency(10));
  EXPECT_EQ(result.modes[10].deviation, fit.frequency_deviations[10]);
  EXPECT_EQ(result.chi2, fit.chi2);
}

TEST(RecordsFit, APluckFindsABlindModeThatLeavesTheLaw) {
  const Strokes one = blind_stroke();
  ModelPoint truth = bowed_case(0.03, 0.0, 0.02).truth;
  truth.basis.omega[10] *= 1.004;  // four half widths of its resonance
  NoisyRecords records{.deviation = {0.01, 0.01}, .sample_rate = 51200.0};
  for (std::size_t r = 0; r < 2; ++r) {
    std::vector<double>& samples = records.reactions[r];
    samples.resize(25600);
    fill_standard_normal(StreamKey(2).with("decays").with(std::uint64_t{r}), samples);
    for (std::size_t j = 0; j < samples.size(); ++j) {
      const double t = static_cast<double>(j) / 51200.0;
      samples[j] *= records.deviation[r];
      for (std::size_t n = 0; n < 50; ++n) {
        const double omega = truth.basis.omega[n], zeta = truth.basis.zeta[n];
        const double sign = r == 1 && n % 2 == 1 ? -1.0 : 1.0;
        samples[j] += sign / static_cast<double>(n + 1) * std::exp(-zeta * omega * t) *
                      std::cos(omega * std::sqrt(1.0 - zeta * zeta) * t);
      }
    }
  }
  const std::vector<PluckRecord> plucks = {as_record(records)};
  const ContinuationResult fit = calibrate_records(one.start, one.data, one.options, plucks);
  EXPECT_TRUE(fit.right) << fit.chi2;
  expect_modes(fit, truth, {11, 22, 33, 44});
}

// A pluck counts among the records that a prior may be stated of.
TEST(RecordsFit, APluckMayHaveAPriorOfItsOwn) {
  Strokes one = blind_stroke();
  UnknownsOptions& unknowns = one.options.unknowns;
  unknowns.sensor[Sensor::kGain].free = true;
  unknowns.per_record = {"gain"};
  unknowns.priors = {{"gain 2", 1.0, 1e-5}};
  const std::vector<PluckRecord> plucks = {as_record(plucked_records(0.0, 0.5, 0.01, 3))};
  const ContinuationResult fit = calibrate_records(one.start, one.data, one.options, plucks);
  ASSERT_EQ(fit.values.size(), 2u);
  EXPECT_LT(fit.values[1].sensor_deviation[0], 1.01e-5);
  EXPECT_GT(fit.values[0].sensor_deviation[0], 1.01e-5);
}

TEST(RecordsFit, EachRecordHasTheGainAndDampingThatAreItsOwn) {
  Strokes two = strokes({0.0285, 0.0291});
  two.options.frequencies = false;
  two.options.unknowns.sensor[Sensor::kGain].free = true;
  // The sensor was changed between the strokes: its signal and its noise.
  CalibrationData& second = two.data[1];
  for (Complex& bin : second.reactions[1]) bin *= 1.03;
  two.options.left_noise = two.options.right_noise = NAN;
  EXPECT_FALSE(calibrate_records(two.start, two.data, two.options).right);
  two.options.unknowns.per_record = {"x_c", "gain"};
  const ContinuationResult own_gain = calibrate_records(two.start, two.data, two.options);
  EXPECT_TRUE(own_gain.right) << own_gain.chi2;
  ASSERT_EQ(own_gain.values.size(), 2u);
  for (const std::size_t r : {0u, 1u}) {
    const RecordValues& values = own_gain.values[r];
    EXPECT_LT(std::abs(values.sensors.gain - (r == 0 ? 1.0 : 1.03)),
              6.0 * values.sensor_deviation[0]);
    EXPECT_LT(values.sensor_deviation[0], 2e-3);
    EXPECT_EQ(values.damping, own_gain.values[0].damping);
  }
  two.options.unknowns.per_record = {"x_c", "gain", "damping"};
  two.options.unknowns.priors = {{"gain 2", 1.03, 1e-7}, {"x_c 2", 0.0291, 1e-9}};
  const ContinuationResult both = calibrate_records(two.start, two.data, two.options);
  EXPECT_TRUE(both.right) << both.chi2;
  EXPECT_NEAR(both.values[1].sensors.gain, 1.03, 1e-6);
  EXPECT_NEAR(both.contacts[1], 0.0291, 1e-8);
  EXPECT_NE(both.values[0].damping, both.values[1].damping);
  for (const RecordValues& values : both.values) {
    EXPECT_LT(std::abs(values.damping - 1.0), 6.0 * values.damping_deviation);
    EXPECT_GT(values.damping_deviation, 1.1 * own_gain.values[0].damping_deviation);
  }
}

TEST(RecordsFit, AModeThatOnlyItsPriorHoldsIsNotIdentified) {
  Strokes one = blind_stroke();
  const double stated = 11.0 * 196.0 * 1.0005;
  one.options.unknowns.priors = {{"f_11", stated, 1e-4 * stated}};
  const ContinuationResult fit = calibrate_records(one.start, one.data, one.options);
  EXPECT_TRUE(fit.right) << fit.chi2;
  for (const ModeVerdict& mode : {fit.modes[10], fit.single[0].modes[10]}) {
    EXPECT_EQ(mode.source, ModeSource::kPrior);
    EXPECT_EQ(mode.reason, WeakReason::kNode);
    EXPECT_GT(mode.data_deviation, 1e-3);
    // The scatter of 0.2 % about the law moves it by 1/400 of what it is from the law.
    EXPECT_NEAR(mode.frequency / stated, 1.0, 2e-5);
    EXPECT_NEAR(mode.deviation, 1e-4, 1e-5);
  }
}

TEST(RecordsFit, FindsAPriorThatTheDataContradict) {
  Strokes two = strokes({0.0285, 0.0291});
  two.options.frequencies = false;
  two.options.unknowns.priors = {{"x_c", 0.0285, 1e-3}, {"x_c 2", 0.035, 1e-3}};
  const ContinuationResult fit = calibrate_records(two.start, two.data, two.options);
  EXPECT_TRUE(fit.fits) << fit.chi2;
  EXPECT_FALSE(fit.right);
  EXPECT_EQ(fit.priors.count, 2u);
  EXPECT_EQ(fit.priors.farthest, "x_c 2");
  EXPECT_NEAR(fit.priors.deviations, 5.9, 0.02);
  EXPECT_FALSE(fit.right);
}

TEST(RecordsFit, HasEveryDampingRatioAboutTheStatedOne) {
  Strokes one = strokes({0.0285});
  one.options.unknowns.damping = "each";
  one.options.unknowns.damping_width = 1e-6;
  for (double& zeta : one.start.basis.zeta) zeta *= 1.05;
  const ContinuationResult fit = calibrate_records(one.start, one.data, one.options);
  for (std::size_t n = 0; n < 50; ++n) {
    EXPECT_NEAR(fit.model.basis.zeta[n] / one.start.basis.zeta[n], 1.0, 1e-4) << n + 1;
  }
}

TEST(RecordsFit, OneContactMayBeShared) {
  Strokes two = strokes({0.0285, 0.0285});
  two.options.frequencies = false;
  const ContinuationResult own = calibrate_records(two.start, two.data, two.options);
  two.options.unknowns.per_record.clear();
  const ContinuationResult shared = calibrate_records(two.start, two.data, two.options);
  EXPECT_TRUE(shared.right) << shared.chi2;
  EXPECT_EQ(shared.contacts[0], shared.contacts[1]);
  EXPECT_LT(std::abs(shared.contacts[0] - 0.0285), 6.0 * shared.contact_deviations[0]);
  // Nothing but the noise differs: informations add, that of x_c by itself and with all else. An
  // x_c of its own profits from the law of both.
  EXPECT_NEAR(shared.contact_deviations[0] / shared.single[0].law.deviation[2], std::sqrt(0.5),
              0.05);
  EXPECT_LT(shared.contact_deviations[0], 0.95 * own.contact_deviations[0]);
  two.options.unknowns.fixed = {{"x_c", 0.0285}};
  const ContinuationResult held = calibrate_records(two.start, two.data, two.options);
  EXPECT_EQ(held.contacts, (std::vector<double>{0.0285, 0.0285}));
}

TEST(RecordsFit, RefusesSharingThatCannotBe) {
  const auto refused = [](std::vector<std::string> per_record, const std::string& reason) {
    UnknownsOptions options;
    options.sensor[Sensor::kGain].free = true;
    options.per_record = std::move(per_record);
    options.priors = {{"gain 2", 1.0, 0.1}};
    try {
      require_priors(options, 3, 2);
      ADD_FAILURE() << "accepted, not refused for " << reason;
    } catch (const InvalidInput& error) {
      EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
    }
  };
  refused({"x_c"}, "all records share it");
  refused({"f0"}, "cannot be each record's own");
  refused({"gain", "gain"}, "twice");
  refused({"gain", "delay"}, "among the sensors");
  UnknownsOptions power;
  power.damping = "power";
  power.per_record = {"damping"};
  EXPECT_THROW(require_priors(power, 3), InvalidInput);
  UnknownsOptions contact;
  contact.priors = {{"x_c 2", 0.03, 1e-3}};
  EXPECT_THROW(contact.require_contacts(1), InvalidInput);
  EXPECT_NO_THROW(contact.require_contacts(2));
}

TEST(RecordsFit, RefusesNoRecord) { EXPECT_THROW(calibrate_records({}, {}, {}), InvalidInput); }

}  // namespace
}  // namespace modcal::records_fit_test
