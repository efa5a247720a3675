#include "libsim/dynamics/friction/friction_law.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "libinverse/observer/friction_candidates.hpp"
#include "libinverse/observer/model_based_estimator.hpp"
#include "libinverse/observer/tuning.hpp"
#include "libsim/base/error.hpp"
#include "libsim/dynamics/fixed_step/fixed_step.hpp"
#include "libsim/dynamics/friction/sliding_laws.hpp"
#include "tests/libinverse/observer/bowed_record.hpp"

namespace modcal::friction_law_test {
namespace {

// Samples on a known curve, once for each direction of the bow: medians and quantiles of a cell lie
// within what the curve changes over the cell's width.
TEST(FrictionCurve, FindsTheCurveBehindTheSamples) {
  for (const double bow : {0.1, -0.1}) {
    std::vector<double> velocity, force;
    for (int i = 0; i < 4000; ++i) {
      const double slip = 0.9 * (i + 0.5) / 4000;
      velocity.push_back(bow > 0.0 ? bow - slip : bow + slip);
      force.push_back((bow > 0.0 ? 1.0 : -1.0) * (0.2 + 0.2 * std::exp(-5.0 * slip)));
    }
    const auto curve = observer::friction_curve(velocity, force, bow, 20);
    ASSERT_EQ(curve.size(), 20u);
    for (const auto& cell : curve) {
      const double expected = 0.2 + 0.2 * std::exp(-5.0 * cell.speed);
      // The first cell lacks the slips below 2 % of the largest, 0.018 of its 0.045 m/s.
      const double shift = cell.speed < 0.045 ? 0.009 : 0.1 * 0.045;
      EXPECT_NEAR(cell.median, expected, shift * 5.0 * 0.2);
      EXPECT_LE(cell.low, cell.median);
      EXPECT_GE(cell.high, cell.median);
      EXPECT_LE(cell.high - cell.low, 0.045 * 5.0 * 0.2);
    }
  }
}

TEST(FrictionCurve, RefusesWhatIsNoPair) {
  const std::vector<double> three(3, 0.0), two(2, 0.0);
  EXPECT_THROW(observer::friction_curve(three, two, 0.1, 5), InvalidInput);
  EXPECT_THROW(observer::friction_curve(three, three, 0.0, 5), InvalidInput);
  EXPECT_THROW(observer::friction_curve(three, three, 0.1, 0), InvalidInput);
}

ModelBasedResult compare_laws(const Choice<FrictionLaw>& law, double duration, double noise,
                              std::vector<std::string> laws) {
  Scene scene = light_scene(duration);
  scene.friction = law;
  // The event-driven simulator has no friction with a state.
  const BowedRecord record = law.selected() == "thermal"
                                 ? record_of<ModalExact>(scene, kLightRate, noise)
                                 : record_of(scene, kLightRate, noise);
  ModelBasedOptions options;
  options.substeps = 4;
  options.rounds = 0;
  options.laws = std::move(laws);
  return ModelBasedEstimator(options).estimate(record.basis, record.scene.bow.position, record.rate,
                                               record.left.samples, record.right.samples);
}

// The round trip: laws that fall with the speed in two shapes, which take longest to tell apart,
// and one that falls with the temperature.
TEST(FrictionCandidates, TheLawThatMadeTheRecordIsNamed) {
  struct Truth {
    std::string name;
    Choice<FrictionLaw> law;
    double duration;
    double noise;
  };
  Hyperbolic::Options slow;
  slow.half_speed = 0.1;
  const Truth truths[] = {
      {"exponential", Choice<FrictionLaw>("coulomb_exponential"), 0.1, 0.05},
      {"hyperbolic", Choice<FrictionLaw>::of<Hyperbolic>("hyperbolic", slow), 0.2, 0.01},
      {"thermal", Choice<FrictionLaw>("thermal"), 0.05, 0.05}};
  for (const Truth& truth : truths) {
    const ModelBasedResult result = compare_laws(truth.law, truth.duration, truth.noise,
                                                 {"exponential", "hyperbolic", "thermal"});
    EXPECT_EQ(result.laws[0].law, truth.name);
    for (std::size_t i = 1; i < 3; ++i) {
      EXPECT_GT(result.laws[i].criterion, result.laws[0].criterion + 20.0) << truth.name;
      EXPECT_GT(result.laws[i].distance, observer::kToldApart) << truth.name;
    }
    // 1/v₀.
    if (truth.name == "hyperbolic") {
      EXPECT_NEAR(result.parameters.sliding.decay, 10.0, 2.0);
    }
  }
}

observer::FrictionCandidate candidate(std::string law, std::size_t parameters,
                                      std::vector<double> block_cost) {
  observer::FrictionCandidate result{.law = std::move(law)};
  result.free_parameters = parameters;
  const double count =
      static_cast<double>(2 * observer::kGainBlock) * static_cast<double>(block_cost.size());
  for (const double cost : block_cost) result.misfit += cost / count;
  result.criterion =
      count * std::log(result.misfit) + static_cast<double>(parameters) * std::log(count);
  result.block_cost = std::move(block_cost);
  return result;
}

// 40 blocks of 512 innovations. A burst in one of them moves the BIC by more than three parameters
// cost, and says nothing about the laws; 2 % in every block says all.
TEST(FrictionCandidates, ABurstNamesNoLaw) {
  std::vector<double> simple(40), rich(40), better(40);
  for (std::size_t b = 0; b < 40; ++b) {
    const double ripple = 10.0 * std::sin(static_cast<double>(b));
    simple[b] = 512.0 + ripple;
    rich[b] = 512.0 - ripple;
    better[b] = 0.96 * 512.0 + ripple;
  }
  simple[7] += 400.0;
  std::vector<observer::FrictionCandidate> laws = {candidate("simple", 7, simple),
                                                   candidate("rich", 10, rich)};
  ASSERT_LT(laws[1].criterion, laws[0].criterion - 100.0);
  observer::rank_friction_laws(laws);
  EXPECT_EQ(laws[0].law, "simple");
  EXPECT_LT(laws[0].distance, observer::kToldApart);
  laws.push_back(candidate("better", 10, better));
  observer::rank_friction_laws(laws);
  EXPECT_EQ(laws[0].law, "better");
}

// The observer's temperature against that of the simulators: the same steady rise, and the same way
// there to the first order of the step.
TEST(BlendedSliding, WarmsAsTheThermalLawDoes) {
  const ThermalSliding law{.hot = 0.2,
                           .drop = 0.6,
                           .softening = 20.0,
                           .softening_width = 6.0,
                           .capacity = 5e-6,
                           .conductance = 2e-3,
                           .carried = 1e-3};
  const double speed = 0.8, force = 0.4, duration = 5e-4;
  double previous = 1.0;
  for (const int steps : {50, 100, 200}) {
    ThermalSliding exact = law;
    observer::BlendedSliding own{.dynamic_force = 0.2, .force_drop = 0.6, .thermal = true};
    own.width = law.softening_width / law.softening;
    own.heating = 1.0 / (law.capacity * law.softening);
    own.cooling = law.conductance / law.capacity;
    own.carried = law.carried / law.capacity;
    for (int i = 0; i < steps; ++i) own.warm(duration / steps, speed, force);
    exact.advance(duration, speed, force);
    const double error = std::abs(own.temperature - exact.rise / law.softening);
    EXPECT_LT(error, 0.6 * previous);
    previous = error;
    // h/2 times the rate 560/s of a rise of at most 1.6.
    EXPECT_LT(error, 0.5 * duration / steps * 560.0 * 1.6);
    EXPECT_NEAR(own.at(speed).force, exact.at(speed).force, 0.6 / 1.2 * error);
  }
}

TEST(FrictionCandidates, UnknownLawsAreRefused) {
  ModelBasedOptions options;
  options.laws = {"parabolic"};
  EXPECT_THROW(ModelBasedEstimator{options}, InvalidInput);
  options.laws = {};
  EXPECT_THROW(ModelBasedEstimator{options}, InvalidInput);
}

}  // namespace
}  // namespace modcal::friction_law_test
