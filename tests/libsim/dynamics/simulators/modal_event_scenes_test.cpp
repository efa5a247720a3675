// The event-driven integrator against the fixed-step one on scenes beyond the paper's: torsion, all
// kinds of strokes, many modes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "libsim/dynamics/energy_audit.hpp"
#include "libsim/dynamics/gestures/ramp_gesture.hpp"
#include "libsim/dynamics/gestures/sine_gesture.hpp"
#include "libsim/dynamics/gestures/table_gesture.hpp"
#include "libsim/dynamics/simulators/modal_event.hpp"
#include "libsim/dynamics/simulators/modal_exact.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal {
namespace {

constexpr double kRate = 50000.0;

Simulation run_with(const Scene& scene, const ModalEvent::Options& options = {},
                    double rate = kRate) {
  return ModalEvent(options).simulate(scene, rate, OutputRequest::all());
}

double relative_error(const Signal& a, const Signal& b) {
  double error = 0.0, power = 0.0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    error += std::pow(a.samples[i] - b.samples[i], 2);
    power += std::pow(b.samples[i], 2);
  }
  return std::sqrt(error / power);
}

double worst_error(const Simulation& a, const Simulation& b) {
  return std::max({relative_error(a.displacement, b.displacement),
                   relative_error(a.velocity, b.velocity), relative_error(a.force, b.force),
                   relative_error(a.left_reaction, b.left_reaction),
                   relative_error(a.right_reaction, b.right_reaction)});
}

// The fixed-step scheme puts switches on its grid: first order, and `largest` at the finest step.
void expect_the_fixed_step_limit(const Scene& scene, double largest) {
  const Simulation event = run_with(scene);
  ASSERT_FALSE(event.diverged_at) << event.explanation;
  EXPECT_GT(event.attachments, 2u);
  const auto distance = [&](double step) {
    const Simulation run =
        ModalExact({.time_step = step}).simulate(scene, kRate, OutputRequest::all());
    return worst_error(run, event);
  };
  const double coarse = distance(1e-6), fine = distance(5e-8);
  EXPECT_LT(fine, largest);
  // Its switches are late by a varying part of a step: over a factor of 20 at least order 0.7.
  EXPECT_GT(std::log(coarse / fine) / std::log(20.0), 0.7) << coarse << " " << fine;
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
  expect_the_fixed_step_limit(torsional_scene(0.01), 5e-3);
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

// The audit replays every mode, the torsional ones too, under the sampled force.
TEST(ModalEventTorsion, EnergyBalances) {
  const Scene scene = torsional_scene(0.02);
  const double rate = 2e6;
  const Simulation run = run_with(scene, {}, rate);
  ASSERT_FALSE(run.diverged_at) << run.explanation;
  const EnergyAccount account = audit_energy(scene, run, ForceHold::kSampled);
  // At each switch the straight line between samples misses at most half a step of the jump of the
  // force, 0.4 N, at the speed there, 0.1 m/s.
  const double missed =
      static_cast<double>(run.attachments + run.releases) * 0.5 / rate * 0.4 * 0.1;
  EXPECT_LT(std::abs(account.residual()), missed + 1e-6 * account.throughput);
  EXPECT_GT(account.dissipated, 10.0 * missed);
}

TEST(ModalEventStroke, ARampIsTheLimitOfTheFixedStepScheme) {
  Scene scene = paper_scene();
  scene.duration = 0.01;
  scene.bow.velocity_gesture = ramp(0.2, 1.0, 0.0, 0.004);
  scene.bow.force_gesture = ramp(0.3, 1.2, 0.001, 0.006);
  expect_the_fixed_step_limit(scene, 3e-3);
}

TEST(ModalEventStroke, ALiftIsTheLimitOfTheFixedStepScheme) {
  Scene scene = paper_scene();
  scene.duration = 0.012;
  scene.bow.force_gesture = table({0.0, 0.004, 0.0045, 0.007, 0.0075}, {1, 1, 0, 0, 1});
  expect_the_fixed_step_limit(scene, 5e-3);
}

TEST(ModalEventStroke, AReversalIsTheLimitOfTheFixedStepScheme) {
  Scene scene = paper_scene();
  scene.duration = 0.012;
  scene.bow.velocity_gesture = table({0.0, 0.005, 0.0065}, {1, 1, -1});
  expect_the_fixed_step_limit(scene, 5e-3);
}

TEST(ModalEventStroke, ATableIsTheLimitOfTheFixedStepScheme) {
  Scene scene = paper_scene();
  scene.duration = 0.01;
  scene.bow.velocity_gesture = table({0.0, 0.00123, 0.0031, 0.0052}, {0.5, 1.3, 0.4, 1.0});
  scene.bow.force_gesture = table({0.0, 0.00217, 0.00401}, {0.4, 1.4, 0.8});
  expect_the_fixed_step_limit(scene, 5e-3);
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
  const Scene scene = scene_of(1200, 2e-3);
  const Simulation event = run_with(scene);
  ASSERT_FALSE(event.diverged_at) << event.explanation;
  EXPECT_GT(event.attachments, 0u);
  const auto distance = [&](double step) {
    const Simulation run =
        ModalExact({.time_step = step}).simulate(scene, kRate, OutputRequest::all());
    return std::max(relative_error(run.velocity, event.velocity),
                    relative_error(run.right_reaction, event.right_reaction));
  };
  const double coarse = distance(4e-7), fine = distance(5e-8);
  EXPECT_LT(fine, 1e-2);
  EXPECT_LT(fine, 0.4 * coarse);
}

}  // namespace
}  // namespace modcal
