// Where the fast loop's coordinates do not tell a mode's state: such steps are the general loop's.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libsim/dynamics/fixed_step/fixed_step.hpp"
#include "libsim/dynamics/fixed_step/step_coefficients.hpp"
#include "libsim/dynamics/friction/friction_law.hpp"
#include "libsim/dynamics/gestures/gesture.hpp"
#include "libsim/model/damping.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::separable_test {
namespace {

// Im r = share · |1 − r| on the unit circle, where |1 − e^{iθ}| = 2 sin(θ/2): cos(θ/2) = share.
ModeWeights turning(double share) {
  const double angle = 2.0 * std::acos(share);
  return {.propagate = {std::cos(angle), std::sin(angle)}, .older = 1.0, .newer = 2.0};
}

TEST(Separable, AsksForATwentiethOfASineInEveryMode) {
  EXPECT_TRUE(are_separable({turning(0.0501)}));
  EXPECT_FALSE(are_separable({turning(0.0499)}));
  EXPECT_TRUE(are_separable({turning(0.5), turning(-0.0501), turning(0.9)}));
  EXPECT_FALSE(are_separable({turning(0.5), turning(-0.0499), turning(0.9)}));
  EXPECT_TRUE(are_separable({}));
}

// r d₁ + d₀ of a quarter turn with d₁ = 1, d₀ = −i + e: e, of a sum of 2 + O(e).
TEST(Separable, AsksForAThousandthOfAForceInEveryMode) {
  const auto driven = [](double rest) {
    return ModeWeights{.propagate = {0.0, 1.0}, .older = {rest, -1.0}, .newer = 1.0};
  };
  EXPECT_TRUE(are_separable({driven(2.01e-3)}));
  EXPECT_FALSE(are_separable({driven(1.99e-3)}));
  EXPECT_FALSE(are_separable({driven(1.0), driven(1.99e-3)}));
}

// Nine undamped modes on multiples of the lowest frequency, the top one of which makes `turns`
// turns a step of 20 µs, and none but it nearly a whole number of half turns: half a turn hides one
// of two coordinates, a whole one the force. The bow is so fast that the string slides throughout,
// under a constant force: nothing amplifies rounding.
Scene turning_scene(double turns) {
  Scene scene = paper_scene();
  scene.string.modes = 9;
  scene.string.fundamental = turns * 50000.0 / 9.0;
  scene.string.damping =
      Choice<DampingLaw>::of<ConstantDamping>("constant", ConstantDamping::Options{0.0});
  scene.initial.velocity.assign(9, 1e-3);
  scene.bow.velocity = 1000.0;
  scene.friction = Choice<FrictionLaw>::of<CoulombExponential>(
      "coulomb_exponential",
      CoulombExponential::Options{.static_coefficient = 0.3, .dynamic_coefficient = 0.3});
  scene.duration = 0.01;
  return scene;
}

double largest_difference(const Signal& a, const Signal& b) {
  double most = 0.0, scale = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    most = std::max(most, std::abs(a.samples[k] - b.samples[k]));
    scale = std::max(scale, std::abs(b.samples[k]));
  }
  return most / scale;
}

// A gesture that moves the bow after the record's end leaves the scene to the general loop.
TEST(Separable, AModeThatNearlyCancelsMovesAsInTheGeneralLoop) {
  for (const double turns : {0.3, 0.5 * (1.0 - 1e-11), 0.5, 1.0 - 1e-8, 1.0}) {
    const Scene scene = turning_scene(turns);
    Scene general = scene;
    general.bow.velocity_gesture =
        Choice<Gesture>::of<TableGesture>("table", TableGesture::Options{{1.0, 2.0}, {1.0, 2.0}});
    const ModalExact simulator({.time_step = 2e-5});
    const Simulation some = simulator.simulate(scene, 50000.0, OutputRequest::all());
    const Simulation other = simulator.simulate(general, 50000.0, OutputRequest::all());
    ASSERT_FALSE(other.diverged_at);
    // 500 steps round to 500 · 1e-16 of the largest mode; nine modes; and coordinates that lie
    // 0.05 apart lose a factor of 20 twice.
    constexpr double kRounding = 500 * 1e-16 * 9 * 400;
    EXPECT_LT(largest_difference(some.velocity, other.velocity), kRounding) << turns;
    EXPECT_LT(largest_difference(some.displacement, other.displacement), kRounding) << turns;
    EXPECT_LT(largest_difference(some.right_reaction, other.right_reaction), kRounding) << turns;
  }
}

}  // namespace
}  // namespace modcal::separable_test
