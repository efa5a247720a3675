#include "libinverse/joint/joint_inversion.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>
#include <numbers>

#include "libinverse/joint/joint_estimator.hpp"
#include "libsim/base/error.hpp"
#include "tests/libinverse/joint/joint_case.hpp"

namespace {
std::atomic<std::size_t> allocations{0};
}  // namespace

[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace modcal {
namespace {

const JumpPrior kJumps{JumpPrior::Options{}};
const LearnedPrior kLearned{LearnedPrior::Options{}};
constexpr InversionOutputs kEverything = {
    .force = true, .displacement = true, .velocity = true, .force_spectrum = true};

JointModel contour_at(double sigma_t, std::size_t samples) {
  return {.sigma = sigma_t * kRate / static_cast<double>(samples)};
}

JointMethod method_with(const ForcePrior& prior, const InversionOutputs& outputs = {}) {
  return {.prior = prior, .offset = OffsetRule::kNone, .outputs = outputs};
}

JointResult invert(const JointInversion& inversion, const ReactionPair& reactions,
                   const SensorNoiseLevel& noise, const JointMethod& method) {
  JointWorkspace workspace;
  JointResult result;
  inversion.invert(reactions, noise, method, workspace, result);
  return result;
}

// The long force without the first and last eighth, where a short record knows least.
double middle_error(std::span<const double> x, std::span<const double> y) {
  const std::size_t edge = y.size() / 8;
  return relative_rms_error(x.subspan(edge, y.size() - 2 * edge),
                            y.subspan(edge, y.size() - 2 * edge));
}

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
  const SensorOptions sensors{.gain = {1.3, 0.8}, .delay = {7e-6, -4e-6}};
  const DrivenString string =
      drive(basis, kPosition, jumping_force(samples, StreamKey(4)), sensors, true, true);
  JointModel model = contour_at(4.0, samples);
  model.static_remainder = true;
  model.bending = true;
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
  for (const auto& change : {+[](JointModel& m) { m.sensors.gain[0] = 1.0; },
                             +[](JointModel& m) { m.sensors.delay[0] = 0.0; },
                             +[](JointModel& m) { m.static_remainder = false; }}) {
    JointModel wrong = model;
    change(wrong);
    EXPECT_GT(error_of(wrong), 1.5 * right);
  }
}

TEST(JointInversion, ForwardOfTheInverseIsTheFilter) {
  const std::size_t samples = 1000;
  const ModalBasis basis = violin_g();
  const JointModel model = contour_at(2.0, samples);
  const JointInversion inversion(basis, kPosition, samples, kRate, model);
  FrequencyGrid grid = FrequencyGrid::of_record(samples, kRate);
  grid.sigma = model.sigma;
  const std::vector<Complex> h = reaction_transfer(basis, kPosition, End::kLeft, grid);
  const std::vector<double> reaction = normal_draw(samples, StreamKey(5));
  const std::vector<double> variance(grid.bins, 0.7);
  const SensorNoiseLevel noise{.rms = {0.3, 0.0}};
  JointMethod method = method_with(kJumps, kEverything);
  method.known_variance = variance;
  const auto result = invert(inversion, {reaction, {}}, noise, method);
  std::vector<double> weighted(samples);
  for (std::size_t j = 0; j < samples; ++j) {
    weighted[j] = reaction[j] * std::exp(-model.sigma * static_cast<double>(j) / kRate);
  }
  const std::vector<Complex> measured = RealFft(samples).forward(weighted);
  for (std::size_t k = 1; k + 1 < grid.bins; ++k) {
    const double q = std::norm(h[k]) / (0.3 * 0.3);
    const Complex filtered = q * 0.7 / (1.0 + q * 0.7) * measured[k];
    EXPECT_LT(std::abs(h[k] * result.identified.force_spectrum[k] - filtered),
              1e-12 * (1.0 + std::abs(measured[k])))
        << k;
  }
}

TEST(JointInversion, IsLinearForAGivenPrior) {
  const std::size_t samples = 777;
  const ModalBasis basis = violin_g();
  const JointInversion inversion(basis, kPosition, samples, kRate, contour_at(2.0, samples));
  const std::vector<double> variance(samples / 2 + 1, 1.0);
  const SensorNoiseLevel noise{.rms = {0.1, 0.2}};
  JointMethod method = method_with(kJumps);
  method.known_variance = variance;
  const auto force_of = [&](std::span<const double> left, std::span<const double> right) {
    return invert(inversion, {left, right}, noise, method).identified.force;
  };
  const auto a = normal_draw(samples, StreamKey(1)), b = normal_draw(samples, StreamKey(2));
  const auto c = normal_draw(samples, StreamKey(3)), d = normal_draw(samples, StreamKey(4));
  std::vector<double> left(samples), right(samples);
  for (std::size_t j = 0; j < samples; ++j) {
    left[j] = a[j] - 3.0 * c[j];
    right[j] = b[j] - 3.0 * d[j];
  }
  const auto first = force_of(a, b), second = force_of(c, d), sum = force_of(left, right);
  for (std::size_t j = 0; j < samples; ++j) {
    EXPECT_NEAR(sum[j], first[j] - 3.0 * second[j], 1e-11);
  }
}

TEST(JointInversion, FollowsAShiftInTime) {
  // The periodic problem knows no beginning.
  const std::size_t samples = 1000, shift = 123;
  const ModalBasis basis = violin_g();
  const JointInversion inversion(basis, kPosition, samples, kRate,
                                 {.truncation = Truncation::kWrapped});
  const SensorNoiseLevel noise{.rms = {0.1, 0.2}};
  const auto a = normal_draw(samples, StreamKey(1)), b = normal_draw(samples, StreamKey(2));
  std::vector<double> later_a(samples), later_b(samples);
  for (std::size_t j = 0; j < samples; ++j) {
    later_a[(j + shift) % samples] = a[j];
    later_b[(j + shift) % samples] = b[j];
  }
  const auto now = invert(inversion, {a, b}, noise, method_with(kLearned)).identified.force;
  const auto later =
      invert(inversion, {later_a, later_b}, noise, method_with(kLearned)).identified.force;
  for (std::size_t j = 0; j < samples; ++j) {
    EXPECT_NEAR(later[(j + shift) % samples], now[j], 1e-9 * standard_deviation(now));
  }
}

TEST(JointInversion, DoesNotMindWhichEndIsLeft) {
  // Seen from the other end the string has x_c → L − x_c, and the reactions change places and sign:
  // they pull the other way.
  const std::size_t samples = 1500;
  const ModalBasis basis = violin_g();
  const DrivenString string = drive(basis, kPosition, jumping_force(samples, StreamKey(6)));
  const JointModel model = contour_at(2.0, samples);
  const JointInversion here(basis, kPosition, samples, kRate, model);
  const JointInversion there(basis, basis.length - kPosition, samples, kRate, model);
  const auto seen = invert(here, string.pair(), {.rms = {0.01, 0.02}}, method_with(kLearned));
  const auto mirrored = invert(there, {string.reaction[1], string.reaction[0]},
                               {.rms = {0.02, 0.01}}, method_with(kLearned));
  const double scale = standard_deviation(seen.identified.force);
  for (std::size_t j = 0; j < samples; ++j) {
    EXPECT_NEAR(mirrored.identified.force[j], seen.identified.force[j], 1e-8 * scale);
  }
}

TEST(JointInversion, ScalesWithTheData) {
  const std::size_t samples = 1000;
  const ModalBasis basis = violin_g();
  const SensorNoise noise(basis, kPosition, samples, kRate, false, false, {});
  const JointInversion inversion(basis, kPosition, samples, kRate, contour_at(2.0, samples));
  const auto a = normal_draw(samples, StreamKey(7)), b = normal_draw(samples, StreamKey(8));
  const auto force_of = [&](double factor) {
    std::vector<double> left = a, right = b;
    for (double& value : left) value *= factor;
    for (double& value : right) value *= factor;
    SensorNoise::Workspace workspace;
    return invert(inversion, {left, right}, noise.estimate({left, right}, workspace),
                  method_with(kLearned, kEverything))
        .identified.force;
  };
  const auto reference = force_of(1.0);
  for (const double factor : {std::ldexp(1.0, 40), std::ldexp(1.0, -40)}) {
    const auto scaled = force_of(factor);
    for (std::size_t j = 0; j < samples; ++j) EXPECT_EQ(scaled[j], factor * reference[j]);
  }
  const double rms = standard_deviation(reference);
  for (const double factor : {1e12, 1e-12}) {
    const auto scaled = force_of(factor);
    for (std::size_t j = 0; j < samples; ++j) {
      EXPECT_NEAR(scaled[j], factor * reference[j], 1e-9 * factor * rms);
    }
  }
}

class EveryLength : public testing::TestWithParam<std::size_t> {};
INSTANTIATE_TEST_SUITE_P(JointInversion, EveryLength,
                         testing::Values(1, 2, 3, 4, 5, 97, 100, 101, 1009));

TEST_P(EveryLength, TakesEveryPriorAndTruncationAndSignal) {
  const std::size_t samples = GetParam();
  const ModalBasis basis = violin_g();
  const SensorNoise sensors(basis, kPosition, samples, kRate, false, false, {});
  for (const Truncation truncation :
       {Truncation::kShiftedContour, Truncation::kTransient, Truncation::kWrapped}) {
    JointModel model;
    model.truncation = truncation;
    if (truncation == Truncation::kShiftedContour) model = contour_at(2.0, samples);
    const JointInversion inversion(basis, kPosition, samples, kRate, model);
    for (const auto& entry : ForcePrior::registry()) {
      const auto prior = Choice<ForcePrior>(entry.name).make();
      for (const auto& signal :
           {std::vector<double>(samples, 0.0), std::vector<double>(samples, 3.0),
            normal_draw(samples, StreamKey(1))}) {
        SensorNoise::Workspace workspace;
        const auto noise = sensors.estimate({signal, signal}, workspace);
        const auto result =
            invert(inversion, {signal, signal}, noise, method_with(*prior, kEverything));
        ASSERT_EQ(result.identified.force.size(), samples);
        for (const auto* values : {&result.identified.force, &result.identified.displacement,
                                   &result.identified.velocity}) {
          for (const double value : *values) ASSERT_TRUE(std::isfinite(value)) << entry.name;
        }
      }
    }
  }
}

TEST(JointInversion, ZeroInZeroOut) {
  const std::size_t samples = 512;
  const JointInversion inversion(violin_g(), kPosition, samples, kRate, contour_at(2.0, samples));
  const std::vector<double> zero(samples, 0.0);
  const auto result = invert(inversion, {zero, zero}, {}, method_with(kLearned));
  for (const double value : result.identified.force) EXPECT_EQ(value, 0.0);
}

TEST(JointInversion, StandsUndampedCoincidentModesAndContactsAtASupport) {
  const std::size_t samples = 1024;  // bins of 50 Hz: modes moved onto them are poles on a bin
  ModalBasis basis = violin_g(0.0);
  basis.omega[3] = basis.omega[2];
  basis.omega[5] = 2.0 * std::numbers::pi * 50.0 * 24.0;
  const auto a = normal_draw(samples, StreamKey(1)), b = normal_draw(samples, StreamKey(2));
  for (const double contact : {kPosition, 0.0, basis.length, 0.5 * basis.length}) {
    const JointInversion inversion(basis, contact, samples, kRate, contour_at(2.0, samples));
    const auto result =
        invert(inversion, {a, b}, {.rms = {0.1, 0.1}}, method_with(kLearned, kEverything));
    for (const double value : result.identified.force) ASSERT_TRUE(std::isfinite(value));
    for (const double value : result.identified.velocity) ASSERT_TRUE(std::isfinite(value));
  }
}

TEST(JointInversion, AllocatesNothingAfterTheFirstCall) {
  const std::size_t samples = 2048;
  const ModalBasis basis = violin_g();
  const SensorNoise sensors(basis, kPosition, samples, kRate, false, false, {});
  const JointInversion inversion(basis, kPosition, samples, kRate, contour_at(2.0, samples));
  const auto a = normal_draw(samples, StreamKey(1)), b = normal_draw(samples, StreamKey(2));
  const auto c = normal_draw(samples, StreamKey(3));
  JointWorkspace workspace;
  JointResult result;
  const JointMethod method = method_with(kLearned, kEverything);
  const auto call = [&](const ReactionPair& pair) {
    inversion.invert(pair, sensors.estimate(pair, workspace.noise), method, workspace, result);
  };
  call({a, b});
  const std::size_t before = allocations;
  call({b, c});
  call({c, a});
  EXPECT_EQ(allocations - before, 0u);
}

// Draws of a force from the prior's own process and of the noise: for these the posterior holds, if
// the amplitude, the noise levels and the spectrum it rests on are found in each record. The first
// and last eighth, where a record from rest is not stationary and its end wraps, are left out.
TEST(JointInversion, NinetyFivePercentBandHoldsTheTruth) {
  const std::size_t samples = 8192, edge = samples / 8;
  const ModalBasis basis = violin_g();
  const SensorNoise sensors(basis, kPosition, samples, kRate, false, false, {});
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

template <typename Call>
std::string refusal_of(Call call) {
  try {
    call();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return "accepted";
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

TEST(SensorNoise, IsMeasuredFromTheRecordAlone) {
  const std::size_t samples = 16384;
  const ModalBasis basis = violin_g();
  const SensorNoise sensors(basis, kPosition, samples, kRate, false, false, {});
  for (const double level : {0.01, 0.1}) {
    DrivenString string = drive(basis, kPosition, jumping_force(samples, StreamKey(10)));
    SensorNoiseLevel truth;
    add_noise(string, level, StreamKey(11), &truth);
    SensorNoise::Workspace workspace;
    const auto estimate = sensors.estimate(string.pair(), workspace);
    EXPECT_TRUE(estimate.measured);
    // 4 segments of about 1000 bins: a standard deviation of 1.5 % in the rms, and leakage.
    for (std::size_t r = 0; r < 2; ++r) EXPECT_NEAR(estimate.rms[r] / truth.rms[r], 1.0, 0.06);
  }
  // Without noise the band holds the tail of the response alone, and the cross relation knows it.
  const DrivenString clean = drive(basis, kPosition, jumping_force(samples, StreamKey(10)));
  SensorNoise::Workspace workspace;
  EXPECT_LT(sensors.estimate(clean.pair(), workspace).noise_share, 1e-2);
}

TEST(ContourOf, LiesBetweenOneAndFourOverTheRecord) {
  const ModalBasis basis = violin_g();
  EXPECT_NEAR(contour_of(basis, 1.0, 1e-12), 4.0, 1e-12);
  EXPECT_NEAR(contour_of(basis, 1.0, 0.5), 1.0, 1e-12);
  const double decay = 1e-3 * 2.0 * std::numbers::pi * 196.0;
  EXPECT_NEAR(contour_of(basis, 1.0, 0.01), 0.5 * (std::log(100.0) - decay), 1e-12);
}

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
