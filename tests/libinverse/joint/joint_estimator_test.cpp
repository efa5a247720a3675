// The joint estimator as an experiment uses it: what is automatic, what is an option.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "libinverse/joint/joint_estimators.hpp"
#include "libsim/base/error.hpp"
#include "libsim/signal/fft.hpp"
#include "tests/libinverse/joint/joint_case.hpp"

namespace modcal {
namespace {

Estimate estimate_with(const JointOptions& joint, const ModalBasis& basis,
                       const ReactionPair& reactions, bool recorded = false) {
  const std::size_t samples = std::max(reactions[0].size(), reactions[1].size());
  JointEstimator::Options options;
  options.joint = joint;
  const auto prepared =
      JointEstimator(options).prepare({basis, kPosition, samples, kRate, recorded});
  const auto regularizer = Choice<Regularizer>("none").make();
  const auto rule = Choice<ParameterChoice>("gcv").make();
  EstimationRecord record;
  record.reactions = reactions;
  return prepared->estimate(record, {*regularizer, *rule, kEverything}).front();
}

double figure(const Estimate& estimate, const std::string& name) {
  const std::map<std::string, double> figures(estimate.figures.begin(), estimate.figures.end());
  return figures.at(name);
}

TEST(JointEstimator, ReportsTheContourItHasChosen) {
  const std::size_t samples = 8192;
  const ModalBasis basis = violin_g();
  const double duration = static_cast<double>(samples) / kRate;
  double before = 5.0;
  for (const double level : {0.001, 0.01, 0.1}) {
    DrivenString string = drive(basis, kPosition, jumping_force(samples, StreamKey(1)));
    add_noise(string, level, StreamKey(2));
    const Estimate estimate = estimate_with({}, basis, string.pair());
    const double sigma_t = figure(estimate, "sigma_T");
    // Quarters of 1/T next to the rule, whose noise is measured to a few percent.
    EXPECT_NEAR(sigma_t, duration * contour_of(basis, duration, level), 0.13 + 0.05) << level;
    EXPECT_EQ(figure(estimate, "sigma"), sigma_t / duration);
    EXPECT_LT(sigma_t, before);  // more noise, less of it let grow
    before = sigma_t;
  }
  JointOptions given;
  given.sigma = 7.0;
  const DrivenString string = drive(basis, kPosition, jumping_force(samples, StreamKey(1)));
  EXPECT_EQ(figure(estimate_with(given, basis, string.pair()), "sigma"), 7.0);
}

TEST(JointEstimator, TakesARecordThatBeginsInMidMotion) {
  // Four periods cut from a longer record; the sensors' levels are lost.
  const std::size_t samples = 1045, before = 3000;
  const ModalBasis basis = violin_g();
  DrivenString string = drive(basis, kPosition, jumping_force(before + samples, StreamKey(2)));
  for (auto& reaction : string.reaction) {
    reaction.erase(reaction.begin(), reaction.begin() + before);
    remove_mean(reaction);
  }
  std::vector<double> force(string.force.begin() + before, string.force.end());
  remove_mean(force);
  JointOptions transient;
  transient.truncation = "transient";
  transient.noise_rms[0] = transient.noise_rms[1] = 1e-8;
  JointOptions contour = transient;
  contour.truncation = "shifted_contour";
  const auto error_with = [&](const JointOptions& options) {
    auto identified = estimate_with(options, basis, string.pair()).result.force;
    remove_mean(identified);
    return middle_error(identified, force);
  };
  EXPECT_LT(error_with(transient), 0.15);
  EXPECT_GT(error_with(contour), 0.5);
}

// Two thirds of a second of a longer record: the string's own motion before it goes on in it.
TEST(JointEstimator, TellsTheMotionOfARecordThatBeginsInMidMotion) {
  const std::size_t samples = 16384, before = 3000;
  const ModalBasis basis = violin_g();
  DrivenString string = drive(basis, kPosition, jumping_force(before + samples, StreamKey(3)));
  add_noise(string, 0.01, StreamKey(4));
  const auto cut = [](std::vector<double>& signal) {
    signal.erase(signal.begin(), signal.begin() + before);
    remove_mean(signal);
  };
  for (auto* signal : {&string.reaction[0], &string.reaction[1], &string.force,
                       &string.displacement, &string.velocity}) {
    cut(*signal);
  }
  const std::array<ReactionPair, 3> records = {
      string.pair(), {string.reaction[0], {}}, {std::span<const double>{}, string.reaction[1]}};
  for (const ReactionPair& record : records) {
    const Estimate estimate = estimate_with({}, basis, record);
    EXPECT_EQ(figure(estimate, "sigma"), 0.0);  // ends unknown, by itself
    EXPECT_THAT(estimate.notes, testing::Contains(testing::HasSubstr("starts at rest")));
    const auto judge = [&](std::vector<double> identified, const std::vector<double>& truth,
                           double deviation, double largest) {
      remove_mean(identified);
      EXPECT_LT(middle_error(identified, truth), largest);
      std::size_t inside = 0;
      for (std::size_t j = 0; j < samples; ++j) {
        inside += std::abs(identified[j] - truth[j]) < 1.96 * deviation ? 1 : 0;
      }
      // The band is the same all along the record, the error grows towards its beginning.
      EXPECT_GT(static_cast<double>(inside), 0.93 * static_cast<double>(samples));
    };
    judge(estimate.result.force, string.force, estimate.force_deviation, 0.6);
    judge(estimate.result.displacement, string.displacement, estimate.displacement_deviation, 0.02);
    judge(estimate.result.velocity, string.velocity, estimate.velocity_deviation, 0.2);
  }
}

TEST(JointEstimator, StaticRemainderIsOnForRecordedStringsUnlessStated) {
  const std::size_t samples = 4096;
  const ModalBasis basis = violin_g();
  const DrivenString string =
      drive(basis, kPosition, jumping_force(samples, StreamKey(4)), {}, true);
  const auto force_with = [&](const char* remainder, bool recorded) {
    JointOptions options;
    options.transfer.remainder = remainder;
    options.truncation = "shifted_contour";  // of records and simulations alike
    options.band_limit = kRate;  // none: a record's own would end below the highest mode
    options.noise_rms[0] = options.noise_rms[1] = 1e-6;
    return estimate_with(options, basis, string.pair(), recorded).result.force;
  };
  const auto on = force_with("law", false), off = force_with("none", true);
  EXPECT_EQ(force_with("auto", true), on);
  EXPECT_EQ(force_with("auto", false), off);
  // The response holds the remainder: without it the error is larger.
  EXPECT_LT(1.5 * middle_error(on, string.force), middle_error(off, string.force));
}

// What lies above the modes of a real string the data do not tell: three modes below the highest
// one a record's estimate ends, and says so; a simulated string has no others.
TEST(JointEstimator, OfARecordEndsBelowTheHighestMode) {
  const std::size_t samples = 8192;
  const ModalBasis basis = violin_g();
  const DrivenString string =
      drive(basis, kPosition, jumping_force(samples, StreamKey(4)), {}, true);
  // Under a window: the growing weight makes the record's end and its beginning differ.
  const auto power_above = [](std::vector<double> force, double frequency) {
    for (std::size_t j = 0; j < force.size(); ++j) {
      const double turn = (static_cast<double>(j) + 0.5) / static_cast<double>(force.size());
      force[j] *= std::pow(std::sin(std::numbers::pi * turn), 2);
    }
    const std::vector<Complex> spectrum = RealFft(force.size()).forward(force);
    double power = 0.0, all = 0.0;
    for (std::size_t k = 1; k < spectrum.size(); ++k) {
      const double at = static_cast<double>(k) * kRate / static_cast<double>(force.size());
      all += std::norm(spectrum[k]);
      if (at > frequency) power += std::norm(spectrum[k]);
    }
    return power / all;
  };
  JointOptions options;
  options.noise_rms[0] = options.noise_rms[1] = 1e-4;
  const Estimate record = estimate_with(options, basis, string.pair(), true);
  EXPECT_EQ(record.band_limit, basis.frequency(46));
  // The contour's weight blurs the limit by σ/2π, less than 1 Hz.
  EXPECT_LT(power_above(record.result.force, 1.05 * basis.frequency(46)), 1e-5);
  ASSERT_EQ(record.notes.size(), 1u);
  EXPECT_THAT(record.notes[0], testing::HasSubstr("3 modes below the highest of 50"));
  const Estimate simulated = estimate_with(options, basis, string.pair(), false);
  EXPECT_TRUE(std::isnan(simulated.band_limit));
  EXPECT_GT(power_above(simulated.result.force, 1.05 * basis.frequency(46)), 1e-4);
  EXPECT_TRUE(simulated.notes.empty());
  options.band_limit = 5000.0;
  const Estimate stated = estimate_with(options, basis, string.pair(), true);
  EXPECT_EQ(stated.band_limit, 5000.0);
  EXPECT_TRUE(stated.notes.empty());
  options.band_limit = std::numeric_limits<double>::quiet_NaN();
  options.limit_to_top_mode = true;
  EXPECT_NEAR(estimate_with(options, basis, string.pair(), true).band_limit,
              1.01 * basis.frequency(49), 1e-6);
}

// Above its modes a real string is not silent: what is read there is five times the noise, what the
// cross relation leaves is the noise.
TEST(JointEstimator, NoiseOfARecordIsWhatTheCrossRelationLeaves) {
  const std::size_t samples = 16384;
  const ModalBasis basis = violin_g();
  for (const double level : {0.002, 0.02}) {
    DrivenString string = drive(basis, kPosition, jumping_force(samples, StreamKey(4)), {}, true);
    SensorNoiseLevel truth;
    add_noise(string, level, StreamKey(5), &truth);
    const Estimate found = estimate_with({}, basis, string.pair(), true);
    // Weighted by exp(−8 t/T) a sixteenth of the bins is independent: 3 %, by their weights twice.
    EXPECT_NEAR(figure(found, "noise_rms_1"), truth.rms[0], 0.12 * truth.rms[0]) << level;
    EXPECT_NEAR(figure(found, "noise_rms_2"), truth.rms[1], 0.12 * truth.rms[1]) << level;
  }
}

TEST(JointEstimator, BendingOfTheSupportsIsAnOption) {
  const std::size_t samples = 4096;
  StringModel model;
  model.length = 0.33;
  model.linear_density = 3.1e-3;
  model.fundamental = 196.0;
  model.inharmonicity = 1e-3;  // reactions of mode 50 times 3.5
  const ModalBasis basis = make_modal_basis(model);
  const DrivenString string =
      drive(basis, kPosition, jumping_force(samples, StreamKey(4)), {}, false, true);
  const auto error_with = [&](bool bending) {
    JointOptions options;
    options.transfer.reaction = bending ? "support" : "tension";
    options.noise_rms[0] = options.noise_rms[1] = 1e-6;
    return middle_error(estimate_with(options, basis, string.pair()).result.force, string.force);
  };
  EXPECT_LT(1.5 * error_with(true), error_with(false));
}

TEST(JointEstimator, GainAndDelayOfEachSensorAreOptions) {
  const std::size_t samples = 4096;
  const ModalBasis basis = violin_g();
  const SensorPair sensors = {Sensor{.gain = 1.3, .delay = 7e-6},
                              Sensor{.gain = 0.8, .delay = -4e-6}};
  const DrivenString string =
      drive(basis, kPosition, jumping_force(samples, StreamKey(4)), sensors);
  JointOptions options;
  options.noise_rms[0] = options.noise_rms[1] = 1e-6;
  const double ignored =
      middle_error(estimate_with(options, basis, string.pair()).result.force, string.force);
  options.sensors = sensors;
  const double known =
      middle_error(estimate_with(options, basis, string.pair()).result.force, string.force);
  EXPECT_LT(3.0 * known, ignored);
}

TEST(JointEstimator, SaysWhenTheSidesContradictEachOther) {
  const std::size_t samples = 8192;
  const ModalBasis basis = violin_g();
  DrivenString string = drive(basis, kPosition, jumping_force(samples, StreamKey(5)));
  add_noise(string, 0.02, StreamKey(6));
  const auto contradiction = testing::Contains(testing::HasSubstr("contradict"));
  const Estimate good = estimate_with({}, basis, string.pair());
  EXPECT_THAT(good.warnings, testing::Not(contradiction));
  // A wrong model of the second sensor, where the noise is said to be small.
  JointOptions wrong;
  wrong.sensors[1].gain = 0.7;
  wrong.noise_rms[0] = wrong.noise_rms[1] = 1e-4 * standard_deviation(string.reaction[0]);
  const Estimate bad = estimate_with(wrong, basis, string.pair());
  EXPECT_THAT(bad.warnings, contradiction);
  JointOptions trusting = wrong;
  trusting.sensors[1].gain = 1.0;
  EXPECT_GT(figure(bad, "misfit_of_sides"),
            figure(estimate_with(trusting, basis, string.pair()), "misfit_of_sides"));
}

// A contact 2 mm beside the true one moves every zero of the transfer functions. Its error along
// the force is as large as across it, which both reactions tell.
TEST(JointEstimator, BandsOfARecordHoldWhatTheModelLacks) {
  const std::size_t samples = 16384;
  const ModalBasis basis = violin_g();
  DrivenString string =
      drive(basis, kPosition + 2e-3, jumping_force(samples, StreamKey(5)), {}, true);
  add_noise(string, 0.01, StreamKey(6));
  JointOptions options;
  options.band_limit = kRate;  // none, so that the truth is that of the whole band
  const Estimate estimate = estimate_with(options, basis, string.pair(), true);
  EXPECT_THAT(estimate.warnings, testing::Contains(testing::HasSubstr("contradict")));
  std::vector<double> force = estimate.result.force, truth = string.force;
  remove_mean(force);
  remove_mean(truth);
  std::size_t inside = 0;
  for (std::size_t j = 0; j < samples; ++j) {
    inside += std::abs(force[j] - truth[j]) < 1.96 * estimate.force_deviation ? 1 : 0;
  }
  EXPECT_GT(static_cast<double>(inside), 0.8 * static_cast<double>(samples));
}

TEST(JointEstimator, ABinThatNeitherSideSeesKeepsThePrior) {
  // At a support nothing is seen: every bin is blind, the force 0, its band the prior's.
  const std::size_t samples = 512;
  const JointInversion inversion(violin_g(), 0.0, samples, kRate, {.sigma = 200.0});
  const auto noise = normal_draw(samples, StreamKey(1));
  const JumpPrior prior{JumpPrior::Options{}};
  const std::vector<double> variance(samples / 2 + 1, 4.0);
  JointWorkspace workspace;
  JointResult result;
  inversion.invert({noise, noise}, {.rms = {0.1, 0.1}},
                   {.prior = prior, .offset = OffsetRule::kNone, .known_variance = variance},
                   workspace, result);
  EXPECT_EQ(result.identified.blind_bins, samples / 2 + 1);
  EXPECT_EQ(result.identified.choice.kept_share, 0.0);
  for (const double value : result.identified.force) EXPECT_EQ(value, 0.0);
  EXPECT_NEAR(result.deviation.force, 2.0, 1e-12);  // K bins of variance 4 over K samples
}

TEST(JointEstimator, FallsBackToTheSideThatWasRecorded) {
  const std::size_t samples = 4096;
  const ModalBasis basis = violin_g();
  const DrivenString string = drive(basis, kPosition, jumping_force(samples, StreamKey(9)));
  const auto prepared =
      Choice<Estimator>("joint").make()->prepare({basis, kPosition, samples, kRate, false});
  const auto regularizer = Choice<Regularizer>("none").make();
  const auto choice = Choice<ParameterChoice>("gcv").make();
  EstimationRecord record;
  record.reactions = {string.reaction[0], {}};
  const auto estimates = prepared->estimate(record, {*regularizer, *choice});
  ASSERT_EQ(estimates.size(), 1u);
  EXPECT_EQ(estimates[0].side, "joint");
  EXPECT_THAT(estimates[0].warnings,
              testing::Contains(testing::HasSubstr("reaction 2 is missing")));
  EXPECT_GT(correlation(estimates[0].result.force, string.force), 0.9);
}

TEST(JointEstimator, LinearLimitNeedsTheTruth) {
  const std::size_t samples = 256;
  const auto prepared = Choice<Estimator>("linear_limit")
                            .make()
                            ->prepare({violin_g(), kPosition, samples, kRate, false});
  const auto regularizer = Choice<Regularizer>("none").make();
  const auto choice = Choice<ParameterChoice>("gcv").make();
  const auto noise = normal_draw(samples, StreamKey(1));
  EstimationRecord record;
  record.reactions = {noise, noise};
  EXPECT_THROW(prepared->estimate(record, {*regularizer, *choice}), InvalidInput);
}

}  // namespace
}  // namespace modcal
