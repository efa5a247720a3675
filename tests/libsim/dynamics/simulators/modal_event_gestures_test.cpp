// The event-driven simulator under gestures of the bow.
#include <gtest/gtest.h>

#include "libsim/dynamics/event/modal_event.hpp"
#include "libsim/dynamics/gestures/gesture.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"
#include "tests/libsim/dynamics/simulators/compared_runs.hpp"

namespace modcal::modal_event_gestures_test {
namespace {

constexpr double kRate = 51200.0;

Simulation run_with(const Scene& scene, const ModalEvent::Options& options = {}) {
  return event_run(scene, options, kRate);
}

// A scene with everything a bow can do: ramps, reversal, a lift, noise on both.
Scene gestured_scene() {
  Scene scene = paper_scene();
  scene.duration = 0.04;
  scene.bow.velocity_gesture = Choice<Gesture>::of<TableGesture>(
      "table", TableGesture::Options{{0.0, 0.003, 0.018, 0.022}, {0.2, 1.0, 1.0, -1.0}});
  scene.bow.force_gesture = Choice<Gesture>::of<TableGesture>(
      "table", TableGesture::Options{{0.0, 0.002, 0.017, 0.018, 0.02, 0.021},
                                     {0.3, 1.0, 1.0, 0.0, 0.0, 1.0}});
  scene.bow.velocity_noise = {.present = true, .level = 0.02, .cutoff = 400.0, .seed = 3};
  scene.bow.force_noise = {.present = true, .level = 0.02, .cutoff = 400.0, .seed = 4};
  return scene;
}

TEST(ModalEvent, ConvergesUnderGesturesAndNoise) {
  const Scene scene = gestured_scene();
  const Simulation run = run_with(scene), fine = run_with(scene, {.max_step = 2.5e-6});
  ASSERT_FALSE(run.diverged_at) << run.explanation;
  EXPECT_EQ(run.attachments, fine.attachments);
  EXPECT_GT(run.attachments, 10u);
  // Order 8: the finer step is 1e3 to 1e5 times better. The bound is that of a steady bow.
  EXPECT_LT(worst_error(run, fine), 1e-5);
}

TEST(ModalEvent, ASteadyGestureIsNoGesture) {
  Scene scene = paper_scene();
  scene.duration = 0.02;
  const Simulation plain = run_with(scene);
  scene.bow.velocity_gesture = Choice<Gesture>::of<TableGesture>(
      "table", TableGesture::Options{{0.0, 0.01, 0.0301}, {1.0, 1.0, 1.0 + 1e-15}});
  const Simulation table = run_with(scene);
  // Steps end at the knot, 512 grid steps behind the start: rounding times 1e4.
  EXPECT_EQ(plain.attachments, table.attachments);
  EXPECT_LT(worst_error(table, plain), 1e-11);
}

// Knots a rounding error behind the points at which sliding steps end: a step of 1e-12 of its
// neighbors says nothing of the force in the next one.
TEST(ModalEvent, StepsOfRoundingLengthChangeNothing) {
  Scene scene = paper_scene();
  scene.duration = 0.02;
  const Simulation plain = run_with(scene);
  TableGesture::Options knots{{0.0}, {1.0}};
  for (int k = 0; k < 1000; ++k) {
    knots.times.push_back((k + 0.5 + 1e-12) / kRate);
    knots.factors.push_back(1.0);
  }
  knots.factors.back() += 1e-15;  // not steady
  scene.bow.velocity_gesture = Choice<Gesture>::of<TableGesture>("table", knots);
  const Simulation cut = run_with(scene);
  ASSERT_FALSE(cut.diverged_at) << cut.explanation;
  EXPECT_EQ(cut.attachments, plain.attachments);
  // The steps are halved, so that the two differ by what the longer ones miss.
  EXPECT_LT(worst_error(cut, plain), 1e-6);
}

}  // namespace
}  // namespace modcal::modal_event_gestures_test
