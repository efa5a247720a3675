#include "libcalib/optimizers/staged/continuation.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "libcalib/identifiability/mode_verdict.hpp"
#include "libcalib/optimizers/staged/newton_fit.hpp"
#include "tests/libcalib/likelihood/bowed_case.hpp"

namespace modcal::continuation_test {
namespace {

ModelPoint wrong_start(ModelPoint point, std::uint64_t seed) {
  std::vector<double> draw(point.basis.size() + 1);
  fill_uniform(StreamKey(seed).with("start"), draw);
  for (std::size_t n = 0; n < point.basis.size(); ++n) {
    point.basis.omega[n] *= 1.0 + 0.02 * (2.0 * draw[n] - 1.0);
  }
  point.contact += 1.5e-3 * (2.0 * draw.back() - 1.0);
  return point;
}

CalibrationData data_of(const NoisyRecords& records) {
  return CalibrationData::of_records(records.reactions[0], records.reactions[1],
                                     records.sample_rate);
}

// Six standard deviations: the failure criterion of the Monte Carlo studies.
constexpr double kSix = 6.0;

void expect_law(const ContinuationResult& result, const ModelPoint& truth, double inharmonicity) {
  EXPECT_LT(std::abs(result.law.fundamental - 196.0), kSix * result.law.deviation[0]);
  EXPECT_LT(std::abs(result.law.inharmonicity - inharmonicity), kSix * result.law.deviation[1]);
  EXPECT_LT(std::abs(result.law.contact - truth.contact), kSix * result.law.deviation[2]);
}

void expect_frequencies(const ContinuationResult& result, const ModelPoint& truth) {
  double square = 0.0;
  double count = 0.0;
  for (std::size_t n = 0; n < result.modes.size(); ++n) {
    const ModeVerdict& mode = result.modes[n];
    if (mode.source != ModeSource::kIdentified) continue;
    const double error = mode.frequency / truth.basis.frequency(n) - 1.0;
    EXPECT_LT(std::abs(error), kSix * mode.deviation) << "mode " << n + 1;
    square += std::pow(error / mode.deviation, 2);
    count += 1.0;
  }
  // Mean of `count` squares of unit variance: sd √(2/count), correlations left aside; five of them.
  // Deviations that are twice as large as the errors would leave a quarter.
  EXPECT_GT(count, 10.0);
  EXPECT_LT(square / count, 1.0 + 5.0 * std::sqrt(2.0 / count));
  EXPECT_GT(square / count, 0.3);
}

TEST(Continuation, FindsThePapersStringFromFarAway) {
  const BowedCase bowed = bowed_case(0.03, 0.0, 1.0);
  for (const double level : {0.01, 0.1}) {
    const ContinuationResult result = calibrate_by_continuation(
        wrong_start(bowed.truth, 11), data_of(noisy(bowed, level, 4)), {.law_width = 2e-3});
    EXPECT_TRUE(result.right) << result.chi2;
    EXPECT_TRUE(result.law.accepted);
    expect_law(result, bowed.truth, 0.0);
    expect_frequencies(result, bowed.truth);
    // The bound at 1 %: 4.2e-4 Hz and 0.294 µm, in proportion to the noise; noise-made JᵀJ and
    // weights move it by a tenth at most.
    EXPECT_NEAR(result.law.deviation[0] / (4.2e-2 * level), 1.0, 0.1);
    EXPECT_NEAR(result.law.deviation[2] / (2.94e-5 * level), 1.0, 0.1);
    for (const std::size_t n : {11u, 22u, 33u, 44u}) {
      EXPECT_EQ(result.modes[n - 1].reason, WeakReason::kNode);
      EXPECT_NE(result.modes[n - 1].source, ModeSource::kIdentified);
    }
  }
}

// In noise as loud as the string the widest rung, which hears a few hundredths of a second, leads
// x_c a hundred deviations away.
TEST(Continuation, AGoodStartIsNotLost) {
  const BowedCase bowed = bowed_case(0.0285, 1.39e-4, 1.0);
  for (const std::uint64_t seed : {3u, 8u}) {
    SCOPED_TRACE(seed);
    const ContinuationResult result = calibrate_by_continuation(
        bowed.truth, data_of(noisy(bowed, 1.0, seed)), {.frequencies = false, .restarts = 0});
    EXPECT_TRUE(result.fits) << result.chi2;
    expect_law(result, bowed.truth, 1.39e-4);
  }
}

TEST(Continuation, SaysThatItIsRightWithoutNoise) {
  const BowedCase bowed = bowed_case(0.0285, 1.39e-4, 1.0);
  const ContinuationResult result = calibrate_by_continuation(
      wrong_start(bowed.truth, 5), data_of(noisy(bowed, 1.0, 1, false)), {});
  EXPECT_TRUE(result.right);
  EXPECT_NEAR(result.law.fundamental, 196.0, 1e-3);
  EXPECT_NEAR(result.law.contact, 0.0285, 2e-6);
}

TEST(Continuation, FreesTheDampingItWasToldWrong) {
  const BowedCase bowed = bowed_case(0.0285, 1.39e-4, 1.0);
  const NoisyRecords records = noisy(bowed, 0.05, 2);
  ModelPoint start = wrong_start(bowed.truth, 7);
  ModelPoint damped = bowed.truth;
  for (double& zeta : start.basis.zeta) zeta *= 1.2;
  for (double& zeta : damped.basis.zeta) zeta *= 1.2;
  const ContinuationResult result = calibrate_by_continuation(
      start, data_of(records),
      {.law_width = 2e-3, .left_noise = records.deviation[0], .right_noise = records.deviation[1]});
  EXPECT_TRUE(result.right);
  EXPECT_NEAR(result.law.damping, 1.0 / 1.2, 0.05);
  expect_law(result, bowed.truth, 1.39e-4);
  // With the wrong damping held, χ² leaves 1 by more than three of its 0.007 whatever else fits.
  const double highest = likelihood_band(start, NAN, 51200.0);
  const ProjectedLikelihood whole(WhitenedRecord::of(records, 0.0, highest));
  const StringUnknowns law = StringUnknowns::law(damped, 196.0, 1.39e-4, {.damping = "fixed"});
  const NewtonFit held = newton_fit(whole, law, law.start(), {.steps = 10});
  EXPECT_GT(2.0 * held.point.cost / whole.degrees_of_freedom(3, damped), 1.02);
}

TEST(Continuation, SaysSoWhenTheModelIsWrong) {
  const BowedCase bowed = bowed_case(0.03, 0.0, 0.25);
  NoisyRecords records = noisy(bowed, 0.01, 3);
  for (double& sample : records.reactions[1]) sample *= 1.1;  // a gain nobody calibrated
  const ContinuationResult result =
      calibrate_by_continuation(wrong_start(bowed.truth, 2), data_of(records), {.restarts = 0});
  EXPECT_FALSE(result.right);
  EXPECT_GT(result.chi2, 1.1);
}

// Reactions of a string whose frequencies are `factors` times the law's, driven by the force of one
// that follows it.
BowedCase deviating_case(double contact, const std::vector<double>& factors) {
  Scene scene = paper_scene();
  scene.bow.position = contact;
  const Simulation run = ModalEvent({}).simulate(scene, 51200.0, {.force = true});
  BowedCase result{.truth = {make_modal_basis(scene.string), contact}};
  for (std::size_t n = 0; n < 50; ++n) result.truth.basis.omega[n] *= factors[n];
  // Eight seconds of decay: the first mode is down to 5e-5 where the transform wraps.
  const std::size_t count = run.force.samples.size();
  std::vector<double> force(8 * count, 0.0);
  std::copy(run.force.samples.begin(), run.force.samples.end(), force.begin());
  const RealFft fft(force.size());
  const std::vector<Complex> spectrum = fft.forward(force);
  for (const End end : {End::kLeft, End::kRight}) {
    const auto r = static_cast<std::size_t>(end);
    std::vector<Complex> reaction = reaction_transfer(
        result.truth.basis, contact, end, FrequencyGrid::of_record(force.size(), 51200.0));
    for (std::size_t k = 0; k < reaction.size(); ++k) reaction[k] *= spectrum[k];
    result.clean[r] = fft.inverse(std::move(reaction));
    result.clean[r].resize(count);
    remove_mean(result.clean[r]);
    result.spread[r] = standard_deviation(result.clean[r]);
  }
  return result;
}

// Frequencies known far better than they follow the law are 45 draws about it: its deviations are
// those of a straight line through ln(f_n/n) over n², whose slope is B/2.
void expect_law_of_scatter(const ContinuationResult& result) {
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  for (std::size_t n = 0; n < result.modes.size(); ++n) {
    const ModeVerdict& mode = result.modes[n];
    if (mode.source != ModeSource::kIdentified) continue;
    const double number = static_cast<double>(n + 1);
    const Eigen::Vector2d row(1.0, 0.5 * number * number);
    normal +=
        row * row.transpose() / std::norm(std::complex(result.law_width, mode.data_deviation));
  }
  const Eigen::Matrix2d covariance = normal.inverse();
  // The scatter of the frequencies is an estimate itself, to √(1/(2·40)) = 11 %, and weak modes
  // take part with less: a third.
  const FoundLaw& law = result.found_law;
  EXPECT_NEAR(law.deviation[0] / (196.0 * std::sqrt(covariance(0, 0))), 1.0, 0.33);
  EXPECT_NEAR(law.deviation[1] / std::sqrt(covariance(1, 1)), 1.0, 0.33);
  EXPECT_LT(std::abs(law.fundamental - 196.0), 4.0 * law.deviation[0]);
  EXPECT_LT(std::abs(law.inharmonicity), 4.0 * law.deviation[1]);
}

TEST(Continuation, FreesTheModesOfAStringThatLeavesTheLaw) {
  std::vector<double> factors(50);
  fill_uniform(StreamKey(3).with("law"), factors);
  for (double& factor : factors) factor = 1.0 + 1e-3 * (2.0 * factor - 1.0);
  const BowedCase bowed = deviating_case(0.0285, factors);
  const ContinuationResult result =
      calibrate_by_continuation(wrong_start(bowed.truth, 21), data_of(noisy(bowed, 0.02, 8)), {});
  EXPECT_FALSE(result.law.accepted);
  EXPECT_TRUE(result.right) << result.chi2;
  expect_frequencies(result, bowed.truth);
  // Uniform ±0.1 % has standard deviation 5.8e-4; √(1/(2·40)) of it is the estimate's own.
  EXPECT_NEAR(result.law_width, 5.8e-4, 2.5e-4);
  expect_law_of_scatter(result);
  EXPECT_LT(std::abs(result.model.contact - 0.0285), kSix * result.contact_deviation);
}

// The law fits at 10 % noise, and would pull the mode back to where its resonance is not.
TEST(Continuation, FindsTheModesThatLeaveALawTheDataAccept) {
  std::vector<double> factors(50, 1.0);
  factors[19] = factors[42] = 1.004;
  const BowedCase bowed = deviating_case(0.0285, factors);
  for (const double level : {0.01, 0.1}) {
    const NoisyRecords records = noisy(bowed, level, 8);
    const ContinuationResult result = calibrate_by_continuation(
        wrong_start(bowed.truth, 21), data_of(records),
        {.left_noise = records.deviation[0], .right_noise = records.deviation[1]});
    EXPECT_TRUE(result.right) << result.chi2;
    for (std::size_t n = 0; n < 50; ++n) {
      const ModeVerdict& mode = result.modes[n];
      const bool leaves = n == 19 || n == 42;
      EXPECT_EQ(mode.tie == LawTie::kLeaves, leaves) << n + 1;
      if (!leaves) continue;
      EXPECT_EQ(mode.source, ModeSource::kIdentified);
      EXPECT_NEAR(mode.departure, 4e-3, 4.0 * mode.deviation);
    }
    expect_frequencies(result, bowed.truth);
    // The law is that of the others, to its own error.
    EXPECT_TRUE(result.law.accepted) << result.law.chi2;
    expect_law(result, bowed.truth, 0.0);
  }
}

TEST(DebiasedHessian, LeavesNoDirectionMuchWorseKnownThanItsPriorHasIt) {
  // The second direction has less information than noise adds in the mean: the draw's scatter.
  NewtonOptions options;
  options.noise = Eigen::Vector2d(0.1, 1.0).asDiagonal();
  options.prior = Eigen::Vector2d(0.0, 1.0).asDiagonal();
  const Eigen::MatrixXd information = Eigen::Vector2d(1.0, 0.2).asDiagonal();
  const Eigen::MatrixXd hessian =
      debiased_hessian(2.0 * information, 2.0 * options.noise, options.prior);
  // 1.4 − 2·0.9ⁿ falls below 0.1 for n = 4: n = 5 it is.
  EXPECT_NEAR(hessian(1, 1), 1.4 - 2.0 * std::pow(0.9, 5), 1e-12);
  EXPECT_NEAR(hessian(0, 0), 2.0 - 0.2 * std::pow(0.9, 5), 1e-12);
}

TEST(LawWidth, IsThatOfTheScatterBeyondTheErrors) {
  std::vector<double> draw(200);
  fill_standard_normal(StreamKey(1).with("width"), draw);
  Eigen::VectorXd delta(200), seen = Eigen::VectorXd::Constant(200, 1e-4);
  for (Eigen::Index n = 0; n < 200; ++n) {
    const double number = static_cast<double>(n + 1);
    delta[n] = 3e-3 + 1e-7 * number * number + 3e-4 * draw[static_cast<std::size_t>(n)];
  }
  // True scatter √(3e-4² − 1e-4²) = 2.83e-4, known to √(1/400) = 5 %; four of them.
  EXPECT_NEAR(find_followers({delta, seen, seen}, 0.0).width, 2.83e-4, 0.6e-4);
  EXPECT_EQ(find_followers({0.3 * delta, seen, seen}, 0.0).width, kTied);
}

}  // namespace
}  // namespace modcal::continuation_test
