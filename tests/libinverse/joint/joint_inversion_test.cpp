#include "libinverse/joint/joint_inversion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "libsim/base/error.hpp"
#include "tests/libinverse/joint/joint_case.hpp"
#include "tests/refusal.hpp"

namespace modcal::joint_inversion_test {
namespace {

TEST(JointInversion, GivesBackTheForceOfARecordThatStillRings) {
  const std::size_t samples = 4096;  // 80 ms: the first mode has lost 10 %
  const ModalBasis basis = violin_g();
  const DrivenString string = drive(basis, kPosition, jumping_force(samples, StreamKey(1)));
  const SensorNoiseLevel noise{.rms = {1e-9, 1e-9}};
  const JointInversion contour(basis, kPosition, samples, kRate, contour_at(4.0, samples));
  const JointInversion wrapped(basis, kPosition, samples, kRate,
                               {.truncation = Truncation::kWrapped});
  const auto of_contour = invert(contour, string.pair(), noise, method_with(kJumps, kEverything));
  const auto of_wrapped = invert(wrapped, string.pair(), noise, method_with(kJumps));
  // What wraps is exp(−4) of the ringing, and both ends must agree on one force: a percent.
  EXPECT_LT(middle_error(of_contour.identified.force, string.force), 0.02);
  EXPECT_GT(middle_error(of_wrapped.identified.force, string.force), 0.05);
  EXPECT_LT(middle_error(of_contour.identified.displacement, string.displacement), 0.02);
  EXPECT_LT(middle_error(of_contour.identified.velocity, string.velocity), 0.02);
}

TEST(JointInversion, LowersTheNoiseOfTwoNoisySensorsOnly) {
  const std::size_t samples = 8192;
  const ModalBasis basis = violin_g();
  DrivenString string = drive(basis, kPosition, jumping_force(samples, StreamKey(1)));
  SensorNoiseLevel truth;
  add_noise(string, 0.01, StreamKey(2), &truth);
  const JointInversion inversion(basis, kPosition, samples, kRate, contour_at(4.0, samples));
  JointWorkspace workspace;
  SensorNoiseLevel read{.rms = {2.0 * truth.rms[0], 2.0 * truth.rms[1]}};
  const auto lowered = [&] {
    return inversion.lowered_noise(string.pair(), read, OffsetRule::kNone, workspace);
  };
  for (std::size_t r = 0; r < 2; ++r) EXPECT_LT(lowered().rms[r], 0.8 * read.rms[r]);
  // One that has none tells nothing of the other.
  for (std::size_t r = 0; r < 2; ++r) {
    read.rms = {2.0 * truth.rms[0], 2.0 * truth.rms[1]};
    read.rms[r] = 0.0;
    EXPECT_EQ(lowered().rms, read.rms);
  }
}

TEST(JointInversion, InvertsFourPeriodsStartedFromRestOrNot) {
  const ModalBasis basis = violin_g();
  const std::size_t samples = 1045;  // 4/196 s
  const std::size_t before = 3000;
  const DrivenString string =
      drive(basis, kPosition, jumping_force(before + samples, StreamKey(2)));
  const SensorNoiseLevel noise{.rms = {1e-8, 1e-8}};
  const auto part = [&](std::span<const double> x, std::size_t start) {
    return x.subspan(start, samples);
  };
  const auto error_of = [&](std::size_t start, const JointModel& model) {
    const JointInversion inversion(basis, kPosition, samples, kRate, model);
    const auto result =
        invert(inversion, {part(string.reaction[0], start), part(string.reaction[1], start)}, noise,
               method_with(kJumps));
    return middle_error(result.identified.force, part(string.force, start));
  };
  EXPECT_LT(error_of(0, contour_at(3.0, samples)), 0.1);
  EXPECT_LT(error_of(0, {.truncation = Truncation::kTransient}), 0.1);
  // In the middle of a motion: 50 modes ring at the start, and more than the force shows.
  EXPECT_LT(error_of(before, {.truncation = Truncation::kTransient}), 0.1);
  EXPECT_GT(error_of(before, contour_at(3.0, samples)), 0.5);
  EXPECT_GT(error_of(before, {.truncation = Truncation::kWrapped}), 0.3);
}

// A window that leaves the ends out takes bins below 0, too: without them a blow at either end
// stands in the lowest eight.
TEST(JointInversion, ErrorsOfTheEndsAreNoSlowErrorsInside) {
  const std::size_t samples = 8192;
  const ModalBasis basis = violin_g();
  DrivenString string = drive(basis, kPosition, jumping_force(samples, StreamKey(3)));
  SensorNoiseLevel noise;
  add_noise(string, 1e-3, StreamKey(30), &noise);
  const JointInversion inversion(basis, kPosition, samples, kRate,
                                 {.truncation = Truncation::kTransient});
  JointMethod method = method_with(kLearned, kEverything);
  method.variances = true;
  const std::vector<double> variance =
      invert(inversion, string.pair(), noise, method).force_variance;
  const auto mean = [&](std::size_t first, std::size_t last) {
    double sum = 0.0;
    for (std::size_t k = first; k < last; ++k) sum += variance[k];
    return sum / static_cast<double>(last - first);
  };
  EXPECT_LT(mean(1, 9), 6.0 * mean(9, 25));  // 12.7 without them, 3.8
}

TEST(JointInversion, BothReactionsTellMoreThanEither) {
  const std::size_t samples = 8192;
  const ModalBasis basis = violin_g();
  DrivenString string = drive(basis, kPosition, jumping_force(samples, StreamKey(3)));
  SensorNoiseLevel noise;
  add_noise(string, 0.05, StreamKey(30), &noise);
  const JointInversion inversion(basis, kPosition, samples, kRate, contour_at(2.0, samples));
  const auto error_of = [&](const ReactionPair& reactions) {
    return middle_error(invert(inversion, reactions, noise, method_with(kLearned)).identified.force,
                        string.force);
  };
  const double both = error_of(string.pair());
  EXPECT_LT(both, error_of({string.reaction[0], {}}));
  EXPECT_LT(both, error_of(ReactionPair{std::span<const double>(), string.reaction[1]}));
}

TEST(JointInversion, KnowsGainDelayRemainderAndBending) {
  const std::size_t samples = 4096;
  const ModalBasis basis = violin_g();
  const SensorPair sensors = {Sensor{.gain = 1.3, .delay = 7e-6},
                              Sensor{.gain = 0.8, .delay = -4e-6}};
  const DrivenString string =
      drive(basis, kPosition, jumping_force(samples, StreamKey(4)), sensors, true, true);
  JointModel model = contour_at(6.0, samples);
  model.support.remainder = true;
  model.support.bending = true;
  model.sensors = sensors;
  const SensorNoiseLevel noise{.rms = {1e-9, 1e-9}};
  const auto error_of = [&](const JointModel& supposed) {
    const JointInversion inversion(basis, kPosition, samples, kRate, supposed);
    return middle_error(
        invert(inversion, string.pair(), noise, method_with(kJumps)).identified.force,
        string.force);
  };
  const double right = error_of(model);
  EXPECT_LT(right, 0.05);
  for (const auto& change : {+[](JointModel& m) { m.sensors[0].gain = 1.0; },
                             +[](JointModel& m) { m.sensors[0].delay = 0.0; },
                             +[](JointModel& m) { m.support.remainder = false; }}) {
    JointModel wrong = model;
    change(wrong);
    EXPECT_GT(error_of(wrong), 1.5 * right);
  }
}

// Draws of a force from the prior's own process and of the noise: for these the posterior holds, if
// the amplitude, the noise levels and the spectrum it rests on are found in each record. The first
// and last eighth, where a record from rest is not stationary and its end wraps, are left out.
TEST(JointInversion, NinetyFivePercentBandHoldsTheTruth) {
  const std::size_t samples = 8192, edge = samples / 8;
  const ModalBasis basis = violin_g();
  const SensorNoise sensors(basis, kPosition, samples, kRate, {}, {});
  const JointInversion inversion(basis, kPosition, samples, kRate, contour_at(2.0, samples));
  JointWorkspace workspace;
  JointResult result;
  double held[3] = {0.0, 0.0, 0.0};
  const std::size_t draws = 200;
  for (std::uint64_t draw = 0; draw < draws; ++draw) {
    DrivenString string =
        drive(basis, kPosition, jumping_force(samples, StreamKey(draw).with("force")));
    add_noise(string, 0.05, StreamKey(draw).with("noise"));
    inversion.invert(string.pair(), sensors.estimate(string.pair(), workspace.noise),
                     method_with(kJumps, kEverything), workspace, result);
    const auto count = [&](std::size_t which, std::span<const double> identified,
                           std::span<const double> truth, double deviation) {
      for (std::size_t j = edge; j < samples - edge; ++j) {
        if (std::abs(identified[j] - truth[j]) <= 1.959964 * deviation) held[which] += 1.0;
      }
    };
    count(0, result.identified.force, string.force, result.deviation.force);
    count(1, result.identified.velocity, string.velocity, result.deviation.velocity);
    count(2, result.identified.displacement, string.displacement, result.deviation.displacement);
  }
  for (const double count : held) {
    const double share = count / static_cast<double>(draws * (samples - 2 * edge));
    EXPECT_GE(share, 0.93);
    EXPECT_LE(share, 0.97);
  }
}

TEST(JointInversion, RefusesWhatItCannotInvert) {
  using testing::HasSubstr;
  const std::size_t samples = 64;
  const JointInversion inversion(violin_g(), kPosition, samples, kRate, contour_at(2.0, samples));
  const auto good = normal_draw(samples, StreamKey(1));
  auto bad = good;
  bad[17] = std::nan("");
  const auto call = [&](const ReactionPair& pair, double rms) {
    return refusal_of([&] { invert(inversion, pair, {.rms = {rms, rms}}, method_with(kJumps)); });
  };
  EXPECT_THAT(call({good, bad}, 0.1), HasSubstr("sample 17 of reaction 2"));
  EXPECT_THAT(call(ReactionPair{}, 0.1), HasSubstr("no reaction"));
  EXPECT_THAT(call({std::span(good).first(63), {}}, 0.1), HasSubstr("63"));
  EXPECT_THAT(call({good, good}, -1.0), HasSubstr("noise level"));
  bad[17] = 1e200;
  EXPECT_THAT(call({bad, good}, 0.1), HasSubstr("overflows"));
  EXPECT_THROW(JointInversion(violin_g(), kPosition, samples, kRate, {.sigma = -1.0}),
               InvalidInput);
  EXPECT_THROW(JointInversion(violin_g(), kPosition, samples, kRate,
                              {.truncation = Truncation::kWrapped, .sigma = 1.0}),
               InvalidInput);
  EXPECT_THROW(JointInversion(violin_g(), 0.4, samples, kRate, {}), InvalidInput);
}

}  // namespace
}  // namespace modcal::joint_inversion_test
