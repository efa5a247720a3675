// The joint estimator as an experiment uses it: what is automatic, what is an option.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "libinverse/joint/joint_estimators.hpp"
#include "libsim/base/error.hpp"
#include "libsim/signal/fft.hpp"
#include "tests/libinverse/joint/joint_case.hpp"

namespace modcal::joint_estimator_test {
namespace {

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

// Nobody who does not know the spectra does better; the prior of jumps is this force's own, but for
// the scatter of the spectrum drawn.
TEST(LinearLimit, IsNotBeatenByWhoDoesNotKnowTheSpectra) {
  const std::size_t samples = 8192;
  const ModalBasis basis = violin_g();
  DrivenString string = drive(basis, kPosition, jumping_force(samples, StreamKey(1)));
  SensorNoiseLevel truth;
  add_noise(string, 0.02, StreamKey(2), &truth);
  const auto regularizer = Choice<Regularizer>("none").make();
  const auto rule = Choice<ParameterChoice>("gcv").make();
  EstimationRecord record;
  record.reactions = string.pair();
  record.stated_noise = truth.rms;
  record.true_force = string.force;
  const Estimate limit = LinearLimitEstimator({})
                             .prepare({basis, kPosition, samples, kRate, false})
                             ->estimate(record, {*regularizer, *rule, kEverything})
                             .front();
  const double found =
      middle_error(estimate_with({}, basis, string.pair()).result.force, string.force);
  EXPECT_LT(middle_error(limit.result.force, string.force), 1.02 * found);
  EXPECT_GT(middle_error(limit.result.force, string.force), 0.5 * found);
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

ModalBasis stiff_violin_g(double inharmonicity) {
  StringModel model;
  model.length = 0.33;
  model.linear_density = 3.1e-3;
  model.fundamental = 196.0;
  model.inharmonicity = inharmonicity;
  return make_modal_basis(model);
}

TEST(JointEstimator, BendingOfTheSupportsIsAnOption) {
  const std::size_t samples = 4096;
  const ModalBasis basis = stiff_violin_g(1e-3);  // reactions of mode 50 times 3.5
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

// A record whose ends feel the bending, of which nobody says so: the force is that of the tension
// alone, and the deviation holds what it is off by. Said once, by the model or the estimator, it is
// right, and the deviation that of the noise.
TEST(JointEstimator, HoldsTheBendingThatNobodyStates) {
  const std::size_t samples = 8192;
  const ModalBasis basis = stiff_violin_g(2e-4);  // reactions of mode 50 times 1.5
  DrivenString string =
      drive(basis, kPosition, jumping_force(samples, StreamKey(4)), {}, true, true);
  add_noise(string, 0.003, StreamKey(2));
  struct Found {
    double coverage, deviation;
    bool is_noted;
  };
  const auto found = [&](const std::string& reaction, std::optional<bool> bending) {
    JointOptions options;
    options.transfer.reaction = reaction;
    options.band_limit = basis.frequency(40);
    const Estimate estimate = estimate_with(options, basis, string.pair(), true, bending);
    const double limit = options.band_limit * static_cast<double>(samples) / kRate;
    const RealFft fft(samples);
    std::vector<Complex> spectrum = fft.forward(string.force);
    for (std::size_t k = 0; k < spectrum.size(); ++k) {
      if (static_cast<double>(k) > limit) spectrum[k] = 0.0;
    }
    const std::vector<double> truth = fft.inverse(std::move(spectrum));
    // But for the static part, which the record does not tell, and for its ends.
    std::vector<double> errors;
    for (std::size_t j = samples / 8; j < 7 * samples / 8; ++j) {
      errors.push_back(estimate.result.force[j] - truth[j]);
    }
    remove_mean(errors);
    const auto held = std::ranges::count_if(
        errors, [&](double error) { return std::abs(error) < 1.96 * estimate.force_deviation; });
    const bool is_noted = std::ranges::any_of(estimate.notes, [](const std::string& note) {
      return note.find("whether the ends feel the bending") != std::string::npos;
    });
    return Found{static_cast<double>(held) / static_cast<double>(errors.size()),
                 estimate.force_deviation, is_noted};
  };
  const Found open = found("auto", {}), wrong = found("tension", {}), right = found("auto", true);
  EXPECT_GT(open.coverage, 0.9);
  EXPECT_LT(wrong.coverage, 0.7);
  EXPECT_GT(right.coverage, 0.9);
  EXPECT_LT(2.0 * right.deviation, open.deviation);
  EXPECT_TRUE(open.is_noted);
  EXPECT_FALSE(wrong.is_noted);
  EXPECT_FALSE(right.is_noted);
  // What the estimator is told goes before what the model says.
  EXPECT_EQ(found("support", false).deviation, right.deviation);
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
              testing::Contains(testing::AllOf(testing::HasSubstr("reaction 2 is missing"),
                                               testing::HasSubstr("record both ends"))));
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
}  // namespace modcal::joint_estimator_test
