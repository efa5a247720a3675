// The list of switches that a simulation gives where it is asked for.
#include <gtest/gtest.h>

#include <cmath>

#include "libsim/dynamics/event/modal_event.hpp"
#include "libsim/dynamics/fixed_step/fixed_step.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::switches_test {
namespace {

constexpr double kRate = 51200.0;

Simulation run_from(double start, const Simulator& simulator = ModalEvent({})) {
  Scene scene = paper_scene();
  scene.duration = 0.1;
  OutputRequest outputs = OutputRequest::all();
  outputs.switches_from = start;
  return simulator.simulate(scene, kRate, outputs);
}

TEST(Switches, AlternateAndAreAllThere) {
  for (const auto& entry : Simulator::registry()) {
    const Simulation run = run_from(0.0, *Choice<Simulator>(entry.name).make());
    ASSERT_GT(run.releases, 20u);
    ASSERT_EQ(run.switches.size(), run.attachments + run.releases);
    // From rest the bow's first touch attaches.
    for (std::size_t i = 0; i < run.switches.size(); ++i) {
      EXPECT_EQ(run.switches[i].attaches, i % 2 == 0) << i;
      if (i == 0) continue;
      EXPECT_GT(run.switches[i].time, run.switches[i - 1].time);
    }
  }
}

// Both converge to the same motion: 1 µs puts a switch on a grid of 1 µs, and the first ones have
// not yet spread that error.
TEST(Switches, OfTheFixedStepsStandWhereTheEventsAre) {
  const Simulation exact = run_from(0.0);
  const Simulation fixed = run_from(0.0, ModalExact({.time_step = 1e-6}));
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(fixed.switches[i].time, exact.switches[i].time, 3e-6) << i;
    EXPECT_NEAR(fixed.switches[i].displacement, exact.switches[i].displacement, 3e-6) << i;
  }
}

// Between two samples y is its cubic through both ends' values and velocities but for
// h⁴/384 max|y''''|, 6e-10 m for a jerk of 1e9 m/s³ per period of mode 50; a switch breaks the
// velocity's slope, which leaves h²/8 · 1e5 m/s² = 5e-6 m at most, 1 % of the motion.
TEST(Switches, StandOnTheMotionOfTheContact) {
  const Simulation run = run_from(0.0);
  for (const Switch& change : run.switches) {
    const auto before = static_cast<std::size_t>(change.time * kRate);
    if (before + 1 >= run.displacement.size()) continue;
    const double theta = change.time * kRate - static_cast<double>(before);
    const double y = run.displacement.samples[before] * (1.0 - theta) +
                     run.displacement.samples[before + 1] * theta;
    EXPECT_NEAR(change.displacement, y, 5e-6) << change.time;
  }
}

TEST(Switches, OfTheLastPartAreThoseOfTheWholeRecord) {
  const Simulation all = run_from(0.0), last = run_from(0.05);
  ASSERT_GT(last.switches.size(), 10u);
  ASSERT_LT(last.switches.size(), all.switches.size());
  const std::size_t skipped = all.switches.size() - last.switches.size();
  EXPECT_LT(all.switches[skipped - 1].time, 0.05);
  for (std::size_t i = 0; i < last.switches.size(); ++i) {
    EXPECT_EQ(last.switches[i].time, all.switches[skipped + i].time);
  }
  EXPECT_TRUE(run_from(HUGE_VAL).switches.empty());
}

}  // namespace
}  // namespace modcal::switches_test
