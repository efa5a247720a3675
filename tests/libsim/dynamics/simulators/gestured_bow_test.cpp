// Motion under gestures of the bow.
#include <gtest/gtest.h>

#include <cmath>

#include "libsim/dynamics/fixed_step/fixed_step.hpp"
#include "libsim/dynamics/friction/friction_law.hpp"
#include "libsim/dynamics/gestures/gesture.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::gestured_bow_test {
namespace {

constexpr double kRate = 50000.0;

Choice<Gesture> table(std::vector<double> times, std::vector<double> factors) {
  return Choice<Gesture>::of<TableGesture>(
      "table", TableGesture::Options{std::move(times), std::move(factors)});
}

Simulation exact(const Scene& scene) {
  return ModalExact({.time_step = 1e-6}).simulate(scene, kRate, OutputRequest::all());
}

// The bow draws the sticking string along: the spring's force is K_a (X(t) − y) − C_a v_c with the
// travel X = ½ a t² of a ramp. Held firmly, the contact follows the bow quasi-statically.
TEST(Gestures, ARampDrawsTheStickingStringAlong) {
  Scene scene = paper_scene();
  scene.duration = 0.02;
  CoulombExponential::Options firm;
  firm.static_coefficient = firm.dynamic_coefficient = 400.0;  // never released
  scene.friction = Choice<FrictionLaw>::of<CoulombExponential>("coulomb_exponential", firm);
  scene.bow.velocity_gesture = Choice<Gesture>::of<RampGesture>(
      "ramp", RampGesture::Options{.from = 0.0, .to = 1.0, .start = 0.0, .duration = 0.04});
  const double acceleration = 0.1 / 0.04;
  for (const char* name : {"modal_exact", "newmark_explicit"}) {
    const Simulation run =
        Choice<Simulator>(name).make()->simulate(scene, kRate, OutputRequest::all());
    EXPECT_EQ(run.releases, 0u);
    const double damping = [&] {
      const ModalBasis basis = make_modal_basis(scene.string);
      const auto shape = basis.shape_at(scene.bow.position);
      double mobility = 0.0;
      for (std::size_t n = 0; n < 50; ++n) mobility += shape[n] * shape[n] / basis.mass[n];
      return 2.0 * std::sqrt(1e5 / mobility);
    }();
    for (std::size_t k = 1; k < run.force.size(); k += 7) {
      const double t = static_cast<double>(k) / kRate;
      const double expected = -1e5 * (run.displacement.samples[k] - 0.5 * acceleration * t * t) -
                              damping * (run.velocity.samples[k] - acceleration * t);
      // Cancellation: 1e5 N/m times the rounding of y and X, 1e-3·1e-16, and of the step's sums.
      EXPECT_NEAR(run.force.samples[k], expected, 1e-9) << name;
    }
    // y follows X within the stretch f/K_a: f = y/receptance, 0.5 mm/(x_c (L − x_c)/(T L)) = 0.95
    // N, and what still rings.
    EXPECT_NEAR(run.displacement.samples.back(), 0.5 * acceleration * std::pow(0.02, 2), 1.5e-5);
  }
}

TEST(Gestures, ALiftedBowLeavesTheStringToItself) {
  Scene scene = paper_scene();
  scene.duration = 0.06;
  scene.bow.force_gesture = table({0.02, 0.025}, {1.0, 0.0});
  const Simulation run = exact(scene);
  const auto lifted = static_cast<std::size_t>(0.025 * kRate) + 1;
  for (std::size_t k = lifted; k < run.force.size(); ++k) ASSERT_EQ(run.force.samples[k], 0.0);
  // From then on each period loses the damping's share and nothing else: modes are harmonic, so
  // one period later every mode n has e^{−ζω_n T}, between e^{−2πζ·50} = 0.73 and e^{−2πζ} = 0.994.
  const double period = kRate / 196.0;
  const auto power = [&](std::size_t from) {
    double sum = 0.0;
    for (std::size_t k = from; k < from + static_cast<std::size_t>(3 * period); ++k) {
      sum += std::pow(run.right_reaction.samples[k], 2);
    }
    return sum;
  };
  const std::size_t later = lifted + static_cast<std::size_t>(3 * period);
  EXPECT_LT(power(later), power(lifted));
  EXPECT_GT(power(later), 0.5 * power(lifted));
}

TEST(Gestures, AReversedBowPullsTheOtherWay) {
  Scene scene = paper_scene();
  scene.duration = 0.2;
  scene.bow.velocity_gesture = table({0.09, 0.11}, {1.0, -1.0});
  const Simulation run = exact(scene);
  const auto mean = [&](double from, double to) {
    double sum = 0.0;
    const auto a = static_cast<std::size_t>(from * kRate), b = static_cast<std::size_t>(to * kRate);
    for (std::size_t k = a; k < b; ++k) sum += run.force.samples[k];
    return sum / static_cast<double>(b - a);
  };
  EXPECT_GT(mean(0.04, 0.09), 0.1);
  EXPECT_LT(mean(0.15, 0.2), -0.1);
}

TEST(Gestures, MirroredGesturesGiveMirroredMotion) {
  Scene scene = paper_scene();
  scene.duration = 0.02;
  scene.bow.velocity_gesture = table({0.0, 0.01, 0.02}, {0.0, 1.0, -0.5});
  Scene mirrored = scene;
  mirrored.bow.velocity = -scene.bow.velocity;
  const Simulation a = exact(scene), b = exact(mirrored);
  for (std::size_t k = 0; k < a.force.size(); ++k) {
    ASSERT_EQ(a.velocity.samples[k], -b.velocity.samples[k]);
    ASSERT_EQ(a.right_reaction.samples[k], -b.right_reaction.samples[k]);
  }
}

}  // namespace
}  // namespace modcal::gestured_bow_test
