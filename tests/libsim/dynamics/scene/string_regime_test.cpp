#include "libsim/dynamics/scene/string_regime.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"
#include "libsim/base/random.hpp"
#include "libsim/dynamics/event/modal_event.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::string_regime_test {
namespace {

constexpr double kRate = 51200.0;
constexpr double kBow = 0.1;

Scene stroke(double duration = 0.3) {
  Scene scene = paper_scene();
  scene.duration = duration;
  return scene;
}

// A contact that sticks at v_bow but for slips [start, start + length), in each of which it goes
// back by `way`.
struct Slip {
  double start, length, way;
};

Simulation record_of(const Scene& scene, const std::vector<Slip>& slips) {
  Simulation run;
  run.velocity = {"v", "m/s", kRate, {}};
  const auto count = static_cast<std::size_t>(scene.duration * kRate);
  run.velocity.samples.assign(count, kBow);
  double way = 0.0;
  for (const Slip& slip : slips) {
    const double end = slip.start + slip.length;
    const double speed = kBow - slip.way / slip.length;
    for (auto k = static_cast<std::size_t>(std::ceil(slip.start * kRate));
         k < count && static_cast<double>(k) < end * kRate; ++k) {
      run.velocity.samples[k] = speed;
    }
    run.switches.push_back({slip.start, kBow * slip.start - way, false});
    way += slip.way;
    if (end < scene.duration) run.switches.push_back({end, kBow * end - way, true});
  }
  return run;
}

// `count` slips in every period, which is `stretch` times the string's.
std::vector<Slip> regular(const Scene& scene, int count, double stretch = 1.0) {
  const double beta = scene.bow.position / scene.string.length;
  const double period = stretch / scene.string.fundamental;
  std::vector<Slip> slips;
  double start = 0.3 * period;
  while (start < scene.duration) {
    slips.push_back({start, beta * period / count, kBow * period / count});
    start += period / count;
  }
  return slips;
}

RegimeFeatures features_of(const Scene& scene, const std::vector<Slip>& slips) {
  return regime_features(scene, record_of(scene, slips), {});
}

StringRegime regime_of(const Scene& scene, const std::vector<Slip>& slips) {
  return classify(features_of(scene, slips), {});
}

TEST(StringRegime, KnowsIdealHelmholtzMotion) {
  const Scene scene = stroke();
  const RegimeFeatures f = features_of(scene, regular(scene, 1));
  EXPECT_EQ(classify(f, {}), StringRegime::kHelmholtz);
  EXPECT_NEAR(f.slips_per_period, 1.0, 0.051);  // one slip of twenty may begin at the end
  // One sample of the slip's 24 may be on either side: 1 − 2/24 of the variance at the least.
  EXPECT_GT(f.periodicity, 1.0 - 2.0 / 24.0);
  EXPECT_NEAR(f.period, 1.0, 0.5 / 261.0);
  EXPECT_NEAR(f.adherence, 1.0 - 0.03 / 0.33, 1e-3);
  // The slip's share of the samples is off by half a sample in 24 at the most.
  EXPECT_NEAR(f.amplitude, 1.0, 0.5 / 24.0);
}

TEST(StringRegime, CountsTheSlipsOfAPeriod) {
  const Scene scene = stroke();
  for (const int count : {2, 3, 4}) {
    const RegimeFeatures f = features_of(scene, regular(scene, count));
    EXPECT_EQ(classify(f, {}), StringRegime::kMultipleSlip) << count;
    EXPECT_NEAR(f.slips_per_period, count, 0.051) << count;
  }
}

TEST(StringRegime, FollowsAPitchThatIsNotTheStrings) {
  const Scene scene = stroke();
  const RegimeFeatures f = features_of(scene, regular(scene, 1, 1.04));
  EXPECT_EQ(classify(f, {}), StringRegime::kHelmholtz);
  EXPECT_NEAR(f.period, 1.04, 0.5 / 261.0);
}

TEST(StringRegime, CallsSlipsWithoutAPeriodRaucous) {
  const Scene scene = stroke();
  std::vector<double> gaps(400);
  fill_uniform(StreamKey(1).with("gaps"), gaps);
  const double period = 1.0 / scene.string.fundamental;
  std::vector<Slip> slips;
  double start = 0.0;
  for (const double gap : gaps) {
    start += period * (0.4 + 1.2 * gap);
    if (start + 0.1 * period > scene.duration) break;
    slips.push_back({start, 0.1 * period, kBow * period});
  }
  EXPECT_EQ(regime_of(scene, slips), StringRegime::kRaucous);
  // A slip every other period is regular, but not with the string's period.
  EXPECT_EQ(regime_of(scene, regular(scene, 1, 2.0)), StringRegime::kRaucous);
}

TEST(StringRegime, DoesNotTakeFlickersForSlips) {
  const Scene scene = stroke();
  const double period = 1.0 / scene.string.fundamental;
  std::vector<Slip> slips;
  for (const Slip& slip : regular(scene, 1)) {
    slips.push_back(slip);
    slips.push_back({slip.start + 0.5 * period, 0.01 * period, 0.03 * kBow * period});
  }
  EXPECT_EQ(regime_of(scene, slips), StringRegime::kHelmholtz);
  for (std::size_t i = 1; i < slips.size(); i += 2) slips[i].way = 0.3 * kBow * period;
  EXPECT_EQ(regime_of(scene, slips), StringRegime::kMultipleSlip);
}

TEST(StringRegime, CallsAHeldAndADyingStringSilent) {
  const Scene scene = stroke();
  EXPECT_EQ(regime_of(scene, {}), StringRegime::kSilent);
  EXPECT_EQ(regime_of(scene, {{0.01, 0.002, 1e-3}}), StringRegime::kSilent);
  // It slides for all but a hundredth of the time.
  Simulation dying = record_of(scene, {});
  for (std::size_t k = 0; k < dying.velocity.size(); ++k) {
    const double t = static_cast<double>(k) / kRate;
    dying.velocity.samples[k] =
        0.05 * std::exp(-2.0 * t) * std::cos(2.0 * std::numbers::pi * scene.string.fundamental * t);
  }
  EXPECT_EQ(classify(regime_features(scene, dying, {}), {}), StringRegime::kSilent);
}

// The longest period sought is 1.25 of the string's, up to a sample.
TEST(StringRegime, FindsAPeriodAtTheEndOfItsRange) {
  const Scene scene = stroke();
  const RegimeFeatures features = features_of(scene, regular(scene, 1, 1.25));
  const double sample = scene.string.fundamental / kRate;
  EXPECT_NEAR(features.period, 1.25, sample);
  EXPECT_GT(features.periodicity, 0.9);
}

TEST(StringRegime, RefusesWhatItCannotJudge) {
  const Scene brief = stroke(0.1);
  EXPECT_THROW(features_of(brief, regular(brief, 1)), InvalidInput);
  Scene still = stroke();
  still.bow.velocity = 0.0;
  EXPECT_THROW(features_of(still, {}), InvalidInput);
}

// The paper's string from Helmholtz motion: Schelleng's limits at this point are 0.05 N and 4.4 N.
TEST(StringRegime, TellsTheMotionsOfASimulatedStringApart) {
  struct Case {
    double force;
    StringRegime regime;
  };
  for (const Case& c : {Case{0.3, StringRegime::kHelmholtz}, Case{2.0, StringRegime::kHelmholtz},
                        Case{10.0, StringRegime::kRaucous}, Case{0.03, StringRegime::kMultipleSlip},
                        Case{1e-3, StringRegime::kSilent}}) {
    Scene scene = stroke(0.5);
    scene.bow.normal_force = c.force;
    scene.initial =
        helmholtz_motion(make_modal_basis(scene.string), scene.bow.position, scene.bow.velocity);
    const Simulation run = ModalEvent({}).simulate(
        scene, kRate, {.velocity = true, .switches_from = judged_from(scene, {})});
    EXPECT_EQ(classify(regime_features(scene, run, {}), {}), c.regime) << c.force;
  }
}

}  // namespace
}  // namespace modcal::string_regime_test
