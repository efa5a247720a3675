// Records of benchmarks/truth, good ones and those of crossed wires.
#include "libinverse/waves/end_relation.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "benchmarks/truth/truth.hpp"
#include "libinverse/waves/end_residual.hpp"
#include "libsim/base/random.hpp"
#include "libsim/signal/statistics.hpp"
#include "tests/refusal.hpp"

namespace modcal::end_relation_test {
namespace {

constexpr double kNoise = 0.01;

// Starts are off by 1.5 % and 1 mm.
const StatedString kStated{
    .length = 0.33, .fundamental = 294.0 * 1.015, .inharmonicity = 1e-4, .contact = 0.042};

truth::TruthRecord stroke(const truth::TruthMismatch& mismatch = {}) {
  truth::TruthRecord record = truth::simulate(
      {}, {.position = 0.041}, {.duration = 0.3, .mismatch = mismatch, .least_rate = 2e6});
  add_noise(record, kNoise, 3);
  return record;
}

const truth::TruthRecord& good() {
  static const truth::TruthRecord record = stroke();
  return record;
}

EndRelationFit fitted(const std::vector<double>& left, const std::vector<double>& right) {
  const double level = kNoise * standard_deviation(good().r1);
  return fit_end_relations({left, right, good().rate, {level, level}}, kStated);
}

std::vector<double> times(double factor, std::vector<double> samples) {
  for (double& x : samples) x *= factor;
  return samples;
}

TEST(EndRelation, OfAStringIsThatOfTheStringStated) {
  for (const truth::TruthMismatch& mismatch :
       {truth::TruthMismatch{},
        {.gain = 1.05, .delay = 2e-6, .corner = 2.0},
        {.body_peak = 0.0125, .polarization = {0.1, 0.03}, .drift = 1e-4}}) {
    const truth::TruthRecord record = stroke(mismatch);
    const EndRelationFit fit = fitted(record.r1, record.r2);
    EXPECT_EQ(fit.best(), EndRelation::kString);
    for (std::size_t other = 1; other < fit.misfit.size(); ++other) {
      EXPECT_GT(fit.misfit[other], 2.5 * fit.misfit_of(EndRelation::kString)) << other;
    }
    EXPECT_LT(fit.unexplained, 0.01);
    EXPECT_FALSE(fit.disturbance.has_value()) << fit.disturbance->ratio;
    EXPECT_NEAR(fit.fundamental, 294.0, 0.004 * 294.0);
    EXPECT_NEAR(fit.contact, 0.041, 2e-3);
  }
}

// A burst in the second period and then nothing but noise that is louder below 1 kHz: the periods
// behind it, which nothing wraps into, hold no string. B = 0: the factors of R1 and R2 are delays.
TEST(EndRelation, OfAStrokeThatIsOverSoonIsThatOfTheWholeRecord) {
  constexpr double rate = 44100.0, fundamental = 220.0, place = 0.12;
  constexpr std::size_t samples = 22050;
  const StatedString string{
      .length = 0.5, .fundamental = fundamental, .inharmonicity = 0.0, .contact = 0.5 * place};
  const auto burst = [](double t) {
    const double x = (t - 1.6 / fundamental) / (0.06 / fundamental);
    return -x * std::exp(-0.5 * x * x);
  };
  std::array<std::vector<double>, 2> noise;
  std::array<std::vector<double>, 2> reactions;
  for (std::size_t r = 0; r < 2; ++r) {
    const double delay = 0.5 * (r == 0 ? 1.0 - place : place) / fundamental;
    noise[r].resize(samples);
    fill_standard_normal(StreamKey(5).with(r), noise[r]);
    double low = 0.0;
    for (std::size_t j = 0; j < samples; ++j) {
      const double t = static_cast<double>(j) / rate;
      low += 0.1 * (noise[r][j] - low);
      reactions[r].push_back(burst(t + delay) - burst(t - delay) + 0.05 * low);
    }
  }
  const EndRelationFit fit =
      fit_end_relations({reactions[0], reactions[1], rate, {0.001, 0.001}}, string);
  EXPECT_EQ(fit.best(), EndRelation::kString);
  EXPECT_LT(fit.unexplained, 0.1);
  // Not of a sign that is wrong.
  EXPECT_GT(
      fit_end_relations({times(-1.0, reactions[0]), reactions[1], rate, {0.001, 0.001}}, string)
          .unexplained,
      0.5);
}

// Of f0 half a per cent off a stroke says so, and nothing of one that is right.
TEST(EndRelation, TellsAnotherFundamentalWhereItServesBetter) {
  const double level = kNoise * standard_deviation(good().r1);
  StatedString string = kStated;
  for (const double off : {-0.01, -0.005, 0.0, 0.005, 0.01}) {
    string.fundamental = 294.0 * (1.0 + off);
    const EndRelationFit fit =
        fit_end_relations({good().r1, good().r2, good().rate, {level, level}}, string);
    EXPECT_EQ(fit.tells_fundamental(), off != 0.0) << off;
    // Both are searched for on grids of their own.
    EXPECT_LT(fit.least_misfit, fit.misfit_as_stated + 0.01) << off;
  }
}

TEST(EndRelation, TellsOfSignsAndExchangedEnds) {
  const std::vector<double>&left = good().r1, &right = good().r2;
  EXPECT_EQ(fitted(times(-1.0, left), right).best(), EndRelation::kSignTurned);
  EXPECT_EQ(fitted(left, times(-1.0, right)).best(), EndRelation::kSignTurned);
  EXPECT_EQ(fitted(right, left).best(), EndRelation::kSwapped);
  EXPECT_EQ(fitted(right, times(-1.0, left)).best(), EndRelation::kSwappedSignTurned);
  // Another sign of the force.
  EXPECT_EQ(fitted(times(-1.0, left), times(-1.0, right)).best(), EndRelation::kString);
}

TEST(EndRelation, TellsTheGainThatOneEndLacks) {
  const double level = kNoise * standard_deviation(good().r1);
  for (const double gain : {0.001, 0.1, 4.448, 30.0}) {
    const std::vector<double> right = times(1.0 / gain, good().r2);
    ASSERT_FALSE(fitted(good().r1, right).explained()) << gain;
    const auto found =
        gain_of_right({good().r1, right, good().rate, {level, level / gain}}, kStated);
    ASSERT_TRUE(found.has_value()) << gain;
    EXPECT_NEAR(*found / gain, 1.0, 0.02);
  }
  const std::vector<double> other = times(1.0, good().r1);
  EXPECT_FALSE(gain_of_right({good().r1, other, good().rate, {level, level}}, kStated).has_value());
}

TEST(EndRelation, TellsOfCopies) {
  for (const double gain : {1.0, 0.7, -1.0}) {
    const EndRelationFit fit = fitted(good().r1, times(gain, good().r1));
    EXPECT_EQ(fit.best(), EndRelation::kCopies);
    EXPECT_NEAR(fit.copy_gain, gain, 1e-12);
  }
  // Through converters with noise of their own.
  truth::TruthRecord two = good();
  two.r2 = two.r1;
  add_noise(two, kNoise, 4);
  EXPECT_EQ(fitted(two.r1, two.r2).best(), EndRelation::kCopies);
}

TEST(EndRelation, TellsOfNoiseAlone) {
  truth::TruthRecord more = good();
  add_noise(more, kNoise, 8);
  for (std::size_t j = 0; j < more.r2.size(); ++j) more.r2[j] -= good().r2[j];
  const double level = kNoise * standard_deviation(good().r2);
  const EndRelationFit fit =
      fit_end_relations({good().r1, more.r2, good().rate, {level, level}}, kStated);
  EXPECT_FALSE(fit.noise_alone(0));
  EXPECT_TRUE(fit.noise_alone(1));
  EXPECT_GT(fit.unexplained, 0.5);
}

TEST(EndRelation, TellsWhereSamplesAreMissing) {
  const auto ratio_at = [](const std::vector<double>& left, const std::vector<double>& right,
                           double time) {
    const EndRelationFit fit = fitted(left, right);
    EXPECT_TRUE(fit.disturbance.has_value());
    if (!fit.disturbance) return;
    EXPECT_NEAR(fit.disturbance->time, time, 1.0 / 294.0);
  };
  for (const std::ptrdiff_t lost : {1, 51, 512}) {
    SCOPED_TRACE(lost);
    std::vector<double> left = good().r1, right = good().r2;
    left.erase(left.begin() + 7000, left.begin() + 7000 + lost);
    right.erase(right.begin() + 7000, right.begin() + 7000 + lost);
    ratio_at(left, right, 7000.0 / good().rate);
  }
  std::vector<double> left = good().r1;
  std::fill_n(left.begin() + 7000, 51, 0.0);
  ratio_at(left, good().r2, 7025.0 / good().rate);
}

// Harmonics in step make a peak a period of the mains, which is many of a violin's E string.
TEST(EndRelation, HumBelowTheStringIsNoGap) {
  truth::TruthRecord record = truth::simulate(
      {.fundamental = 659.3, .inharmonicity = 5e-5, .length = 0.325, .linear_density = 3.8e-4},
      {.position = 0.0287}, {.duration = 0.3, .least_rate = 2e6});
  const double level = 0.01 * standard_deviation(record.r1);
  for (std::size_t j = 0; j < record.r1.size(); ++j) {
    for (const double harmonic : {1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0}) {
      const double t = static_cast<double>(j) / record.rate;
      record.r2[j] += 5.0 * level / harmonic * std::cos(100.0 * std::numbers::pi * harmonic * t);
    }
  }
  add_noise(record, 0.01, 3);
  const EndRelationFit fit = fit_end_relations(
      {record.r1, record.r2, record.rate, {level, level}},
      {.length = 0.325, .fundamental = 659.3, .inharmonicity = 5e-5, .contact = 0.0287});
  EXPECT_FALSE(fit.disturbance.has_value()) << fit.disturbance->ratio;
}

// With noise x_c is found to a few millimeters. Off by 7 mm the start of a stroke on a violin's E
// string leaves some four times as much as elsewhere, without a sample lost.
TEST(EndRelation, AnotherContactIsNoGap) {
  truth::TruthRecord record = truth::simulate(
      {.fundamental = 659.3,
       .inharmonicity = 5e-5,
       .length = 0.325,
       .linear_density = 3.8e-4,
       .loss = 5.0,
       .diffusion = 1.6e-3},
      {.position = 0.0287,
       .action = truth::TruthBow{.velocity = {{0.0, 0.2}}, .normal_force = {{0.0, 1.36}}}},
      {.duration = 0.3});
  add_noise(record, 0.05, 7);
  const StatedString off{
      .length = 0.325, .fundamental = 659.3, .inharmonicity = 5e-5, .contact = 0.0216};
  const auto judged = [&](const truth::TruthRecord& of, double stated_contact) {
    EndRelationFit fit;
    judge_residual({of.r1, of.r2, of.rate, {of.noise[0], of.noise[1]}}, off, stated_contact, fit);
    return fit.disturbance;
  };
  // About a contact that no string has there is nothing else to try.
  EXPECT_TRUE(judged(record, 1.0).has_value());
  EXPECT_FALSE(judged(record, 0.0274).has_value());
  truth::TruthRecord lost = record;
  for (std::vector<double>* reaction : {&lost.r1, &lost.r2}) {
    reaction->erase(reaction->begin() + 7000, reaction->begin() + 7051);
  }
  const auto gap = judged(lost, 0.0274);
  ASSERT_TRUE(gap.has_value());
  EXPECT_NEAR(gap->time, 7000.0 / record.rate, 1.0 / 659.3);
}

TEST(EndRelation, LeavesWhatIsOfNoStringUnexplained) {
  std::vector<double> late = good().r2;
  std::rotate(late.rbegin(), late.rbegin() + 51, late.rend());
  EXPECT_GT(fitted(good().r1, late).unexplained, 0.3);
  StatedString other = kStated;
  other.fundamental *= 48.0 / 44.1;
  const double level = kNoise * standard_deviation(good().r1);
  EXPECT_GT(
      fit_end_relations({good().r1, good().r2, good().rate, {level, level}}, other).unexplained,
      0.05);
}

TEST(EndRelation, RefusesWhatItCannotJudge) {
  const std::vector<double> four(4, 1.0), many(1000, 1.0);
  EXPECT_NE(refusal_of([&] { fitted(four, four); }).find("less than two periods"),
            std::string::npos);
  EXPECT_NE(refusal_of([&] { fitted(four, many); }).find("4 and 1000 samples"), std::string::npos);
  StatedString outside = kStated;
  outside.contact = 0.4;
  EXPECT_NE(refusal_of([&] {
              fit_end_relations({many, many, 51200.0, {}}, outside);
            }).find("not inside the string"),
            std::string::npos);
}

}  // namespace
}  // namespace modcal::end_relation_test
