// The event-driven integrator against the fixed-step one on scenes beyond the paper's: torsion, all
// kinds of strokes, many modes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "libsim/dynamics/gestures/gesture.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"
#include "tests/libsim/dynamics/simulators/compared_runs.hpp"

namespace modcal::modal_event_scenes_test {
namespace {

constexpr double kRate = 50000.0;

Simulation run_with(const Scene& scene, const ModalEvent::Options& options = {},
                    double rate = kRate) {
  return event_run(scene, options, rate);
}

Choice<Gesture> table(std::vector<double> times, std::vector<double> factors) {
  return Choice<Gesture>::of<TableGesture>(
      "table", TableGesture::Options{std::move(times), std::move(factors)});
}
Choice<Gesture> ramp(double from, double to, double start, double duration) {
  return Choice<Gesture>::of<RampGesture>("ramp", RampGesture::Options{from, to, start, duration});
}

Scene torsional_scene(double duration) {
  Scene scene = paper_scene();
  scene.duration = duration;
  scene.torsion.present = true;
  return scene;
}

TEST(ModalEventTorsion, IsTheLimitOfTheFixedStepScheme) {
  expect_the_fixed_step_limit(torsional_scene(0.01), kRate);
}

TEST(ModalEventTorsion, IsConvergedAndDiffersFromARigidString) {
  Scene scene = torsional_scene(0.05);
  const Simulation run = run_with(scene), fine = run_with(scene, {.max_step = 2.5e-6});
  ASSERT_FALSE(run.diverged_at) << run.explanation;
  EXPECT_EQ(run.attachments, fine.attachments);
  EXPECT_LT(worst_error(run, fine), 1e-5);  // the demand on a truth
  scene.torsion.present = false;
  EXPECT_GT(relative_error(run_with(scene).velocity, fine.velocity), 0.05);
}

TEST(ModalEventStroke, ARampIsTheLimitOfTheFixedStepScheme) {
  Scene scene = paper_scene();
  scene.duration = 0.01;
  scene.bow.velocity_gesture = ramp(0.2, 1.0, 0.0, 0.004);
  scene.bow.force_gesture = ramp(0.3, 1.2, 0.001, 0.006);
  expect_the_fixed_step_limit(scene, kRate);
}

TEST(ModalEventStroke, ALiftIsTheLimitOfTheFixedStepScheme) {
  Scene scene = paper_scene();
  scene.duration = 0.012;
  scene.bow.force_gesture = table({0.0, 0.004, 0.0045, 0.007, 0.0075}, {1, 1, 0, 0, 1});
  expect_the_fixed_step_limit(scene, kRate);
}

TEST(ModalEventStroke, AReversalIsTheLimitOfTheFixedStepScheme) {
  Scene scene = paper_scene();
  scene.duration = 0.012;
  scene.bow.velocity_gesture = table({0.0, 0.005, 0.0065}, {1, 1, -1});
  expect_the_fixed_step_limit(scene, kRate);
}

TEST(ModalEventStroke, ATableIsTheLimitOfTheFixedStepScheme) {
  Scene scene = paper_scene();
  scene.duration = 0.01;
  scene.bow.velocity_gesture = table({0.0, 0.00123, 0.0031, 0.0052}, {0.5, 1.3, 0.4, 1.0});
  scene.bow.force_gesture = table({0.0, 0.00217, 0.00401}, {0.4, 1.4, 0.8});
  expect_the_fixed_step_limit(scene, kRate);
}

Scene scene_of(std::int64_t modes, double duration) {
  Scene scene = paper_scene();
  scene.string.modes = modes;
  scene.duration = duration;
  return scene;
}

// More modes than the change of coordinates keeps in memory; the first wave has come back from both
// ends, 0.15 and 1.7 ms after the start, and the string has slipped.
TEST(ModalEventManyModes, AreTheLimitOfTheFixedStepScheme) {
  expect_the_fixed_step_limit(scene_of(1200, 2e-3), kRate);
}

}  // namespace
}  // namespace modcal::modal_event_scenes_test
