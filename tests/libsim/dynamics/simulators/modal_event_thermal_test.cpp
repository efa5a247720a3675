// The event-driven integrator under friction with a temperature.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "libsim/base/random.hpp"
#include "libsim/dynamics/event/event_loop.hpp"
#include "libsim/dynamics/event/sticking.hpp"
#include "libsim/dynamics/friction/friction_law.hpp"
#include "libsim/dynamics/gestures/gesture.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"
#include "tests/libsim/dynamics/simulators/compared_runs.hpp"

namespace modcal::modal_event_thermal_test {
namespace {

Scene thermal_scene(double duration, const Thermal::Options& law = {}) {
  Scene scene = paper_scene();
  scene.duration = duration;
  scene.friction = Choice<FrictionLaw>::of<Thermal>("thermal", law);
  return scene;
}

Simulation run_with(const Scene& scene, const ModalEvent::Options& options = {},
                    double rate = 25000.0) {
  return event_run(scene, options, rate);
}

// As for a friction curve: temperature and force are collocated at the same nodes. Steps above the
// rounding floor, about 1e-12 over 20 ms here.
TEST(ModalEventThermal, ConvergesAtTheOrderOfItsNodes) {
  const Scene scene = thermal_scene(0.02, {.softening_rise = 10.0});
  const auto run = [&](std::int64_t nodes, double step) {
    return run_with(
        scene,
        {.nodes = nodes, .max_step = step, .slope_number = 0.7 * step / 4e-5, .tail_ratio = 1e3});
  };
  const Simulation reference = run(5, 2e-6);
  ASSERT_FALSE(reference.diverged_at) << reference.explanation;
  EXPECT_GT(reference.releases, 5u);
  struct Case {
    std::int64_t nodes;
    double step;
  };
  for (const Case& c : {Case{2, 5e-6}, Case{3, 5e-6}, Case{4, 2e-5}, Case{5, 2e-5}}) {
    const Simulation coarse = run(c.nodes, c.step), fine = run(c.nodes, c.step / 2.0);
    EXPECT_EQ(coarse.attachments, reference.attachments);
    EXPECT_NEAR(std::log2(relative_error(coarse.force, reference.force) /
                          relative_error(fine.force, reference.force)),
                2.0 * static_cast<double>(c.nodes - 1), 0.4)
        << c.nodes << " nodes";
  }
}

TEST(ModalEventThermal, TheFixedStepSchemeApproachesIt) {
  expect_the_fixed_step_limit(thermal_scene(0.02), 25000.0);
}

Scene gestured_scene() {
  Scene scene = thermal_scene(0.03);
  scene.bow.velocity_gesture = Choice<Gesture>::of<TableGesture>(
      "table", TableGesture::Options{{0.0, 0.003, 0.016, 0.018, 0.022}, {0.2, 1, 1, -1, -1}});
  scene.bow.force_gesture = Choice<Gesture>::of<TableGesture>(
      "table", TableGesture::Options{{0.0, 0.002, 0.013, 0.014, 0.0161, 0.017},
                                     {0.3, 1.0, 1.0, 0.0, 0.0, 1.0}});
  return scene;
}

// Ramps, a reversal, and a lift in which the contact cools.
TEST(ModalEventThermal, TheFixedStepSchemeApproachesItUnderGestures) {
  expect_the_fixed_step_limit(gestured_scene(), 25000.0);
}

TEST(ModalEventThermal, IsConvergedAtTheSamplingPeriodUnderGestures) {
  const Scene scene = gestured_scene();
  for (const char* rule : {"literal", "continuous"}) {
    const Simulation run = run_with(scene, {.attach = rule}, 51200.0);
    const Simulation fine = run_with(scene, {.max_step = 2.5e-6, .attach = rule}, 51200.0);
    ASSERT_FALSE(run.diverged_at) << run.explanation;
    EXPECT_EQ(run.attachments, fine.attachments);
    // The demand on a truth; order 8 makes the finer step 1e3 times better at least.
    EXPECT_LT(relative_error(run.force, fine.force), 1e-5) << rule;
    EXPECT_LT(relative_error(run.velocity, fine.velocity), 1e-5) << rule;
  }
}

TEST(ModalEventThermal, HoldsWithLawsOfAllKinds) {
  std::array<double, 5> u{};
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    fill_uniform(StreamKey(seed).with("thermal scene"), u);
    Thermal::Options law;
    law.softening_rise = 5.0 + 40.0 * u[0];
    law.softening_width = 2.0 + 8.0 * u[1];
    law.heat_capacity = 2e-6 * std::pow(10.0, u[2]);
    law.conductance = seed % 4 == 0 ? 0.0 : 5e-3 * u[3];
    Scene scene = thermal_scene(0.02, law);
    scene.bow.normal_force = 0.2 * std::pow(10.0, u[4]);
    scene.bow.velocity = 0.05 + 0.2 * u[0];
    scene.bow.position = 0.015 + 0.1 * u[2];
    const Simulation run = run_with(scene, {}, 51200.0);
    const Simulation fine = run_with(scene, {.max_step = 4e-6}, 51200.0);
    ASSERT_FALSE(run.diverged_at) << run.explanation;
    EXPECT_LT(relative_error(run.velocity, fine.velocity), 1e-3) << seed;
  }
}

// A coefficient that does not soften is Coulomb's, through other equations.
TEST(ModalEventThermal, WithoutSofteningItIsCoulombFriction) {
  const Thermal::Options constant{.cold_coefficient = 0.3, .hot_coefficient = 0.3};
  CoulombExponential::Options curve;
  curve.static_coefficient = curve.dynamic_coefficient = 0.3;
  for (const bool steady : {true, false}) {
    Scene scene = thermal_scene(0.02, constant);
    scene.bow.normal_force = 1.5;
    if (!steady) {
      scene.bow.velocity_gesture = Choice<Gesture>::of<TableGesture>(
          "table", TableGesture::Options{{0.0, 0.004, 0.008, 0.012, 0.016}, {1, -1, 1, -1, 1}});
    }
    const Simulation thermal = run_with(scene);
    scene.friction = Choice<FrictionLaw>::of<CoulombExponential>("coulomb_exponential", curve);
    const Simulation coulomb = run_with(scene);
    EXPECT_EQ(thermal.attachments, coulomb.attachments);
    EXPECT_GE(coulomb.attachments, 1u);
    // Rounding (1e-15) times the contact's sensitivity, below 1e4 over 20 ms.
    EXPECT_LT(relative_error(thermal.velocity, coulomb.velocity), 1e-11);
    EXPECT_LT(relative_error(thermal.force, coulomb.force), 1e-11);
  }
}

namespace event_level {

using event::EventLoop;
using event::EventState;

const ThermalSliding kLaw = {.hot = 0.2,
                             .drop = 0.6,
                             .softening = 20.0,
                             .softening_width = 6.0,
                             .capacity = 5e-6,
                             .conductance = 2e-3,
                             .carried = 1e-3};

EventLoop loop_for(const ContactModes& modes, std::size_t samples, double step,
                   std::vector<event::BowKnot> bow) {
  return {.contact = {.bow_velocity = 0.0,
                      .static_limit = kLaw.at(0.0).force,
                      .stiffness = 1e5,
                      .damping = 2.0 * std::sqrt(1e5 * modes.effective_mass())},
          .thermal = kLaw,
          .bow = std::move(bow),
          .grid_step = step,
          .samples = samples};
}

ContactModes paper_modes() {
  const Scene scene = paper_scene();
  return contact_modes(make_modal_basis(scene.string), scene.bow.position, {});
}

// H ϑ' = |f v_c| − (G + S |v_c|) ϑ by the trapezoidal rule on the record: friction heats the
// contact while it slides, adherence does not.
TEST(EventLoopThermal, TheTemperatureIsThatOfTheHeatOfTheSlip) {
  const ContactModes modes = paper_modes();
  const std::size_t samples = 40001;
  const double h = 2.5e-7, bow = 0.1;
  EventLoop loop = loop_for(modes, samples, h, {{0.0, bow, 1.0}});
  std::vector<double> force(samples), velocity(samples);
  loop.targets = {.velocity = velocity.data(), .force = force.data()};
  std::vector<Switch> switches;
  loop.switches = {&switches, 0.0};
  EventState state = event::initial_state(modes, bow);
  const event::EventCounts counts = run_event_loop(loop, modes, state);
  ASSERT_FALSE(counts.failure) << *counts.failure;
  double rise = 0.0;
  bool sticking = false;
  std::size_t next = 0;
  for (std::size_t k = 0; k + 1 < samples; ++k) {
    while (next < switches.size() && switches[next].time <= static_cast<double>(k) * h) {
      sticking = switches[next++].attaches;
    }
    const auto rate = [&](std::size_t i, double at) {
      const double speed = sticking ? 0.0 : std::abs(velocity[i] - bow);
      return (std::abs(force[i]) * speed - (kLaw.conductance + kLaw.carried * speed) * at) /
             kLaw.capacity;
    };
    const double guess = rise + h * rate(k, rise);
    rise += 0.5 * h * (rate(k, rise) + rate(k + 1, guess));
  }
  EXPECT_GT(state.rise, 5.0);
  EXPECT_GT(switches.size(), 5u);
  // A switch inside a step leaves the rule with one wrong end: half a step of 0.8 N times the
  // speed at its other end, at most 0.05 m/s after a release that jumps to the sliding branch.
  const double missed = 0.5 * h * 0.8 * 0.05 / kLaw.capacity * static_cast<double>(switches.size());
  EXPECT_NEAR(state.rise, rise, missed);
  EXPECT_LT(missed, 0.01 * rise);
}

TEST(EventLoopThermal, GoesOnFromWhereItStopped) {
  const ContactModes modes = paper_modes();
  const double step = 2e-5;
  const std::vector<event::BowKnot> stroke = {{0.0, 0.1, 0.2},         {1.00005e-3, 0.2, 1.0},
                                              {3.01315e-3, 0.12, 0.8}, {5.00005e-3, 0.1, 0.0},
                                              {5.50095e-3, 0.1, 0.0},  {6.00035e-3, -0.1, 1.0}};
  EventState whole = event::initial_state(modes, 0.1);
  const auto all = run_event_loop(loop_for(modes, 401, step, stroke), modes, whole);
  for (const std::size_t first : {20u, 151u, 262u, 330u}) {
    EventState parts = event::initial_state(modes, 0.1);
    const auto a = run_event_loop(loop_for(modes, first + 1, step, stroke), modes, parts);
    std::vector<event::BowKnot> rest = stroke;
    for (event::BowKnot& knot : rest) knot.time -= static_cast<double>(first) * step;
    const auto b = run_event_loop(loop_for(modes, 401 - first, step, rest), modes, parts);
    ASSERT_FALSE(all.failure || a.failure || b.failure);
    EXPECT_EQ(all.attachments, a.attachments + b.attachments);
    EXPECT_EQ(all.releases, a.releases + b.releases);
    double error = 0.0, size = 0.0;
    for (std::size_t n = 0; n < modes.size(); ++n) {
      error += std::norm(parts.modes.at(n) - whole.modes.at(n));
      size += std::norm(whole.modes.at(n));
    }
    // Rounding of the change of coordinates at the joint times the contact's sensitivity.
    EXPECT_LT(std::sqrt(error / size), 1e-11) << first;
    EXPECT_NEAR(parts.rise, whole.rise, 1e-11 * whole.rise) << first;
  }
}

TEST(EventLoopThermal, ABowThatFindsTheStringMovingSlides) {
  const ContactModes modes = paper_modes();
  // In the air and at rest at first; it touches down while it moves.
  EventLoop loop =
      loop_for(modes, 101, 2e-5, {{0.0, 0.0, 0.0}, {5e-4, 0.1, 0.0}, {6e-4, 0.1, 1.0}});
  std::vector<double> force(101);
  loop.targets.force = force.data();
  EventState state = event::initial_state(modes, 0.0);
  state.rise = 30.0;
  ASSERT_TRUE(state.sticking);
  const auto counts = run_event_loop(loop, modes, state);
  ASSERT_FALSE(counts.failure) << *counts.failure;
  EXPECT_EQ(force[24], 0.0);
  // 26 steps after the start the load is 0.2 N; the contact has cooled by e^{−0.2} in the air and
  // slides against the bow's 0.1 m/s at 0.2 N for 20 µs: that changes ϑ by less than 0.3 K.
  const double cooled = 30.0 * std::exp(-400.0 * 5.2e-4);
  const auto limits = [&](double by) { return 0.2 * kLaw.softening_at(cooled + by).coefficient; };
  EXPECT_LT(force[26], limits(-0.3));
  EXPECT_GT(force[26], limits(0.3));
}

TEST(StaticLimit, SeriesAndValueAgree) {
  for (const double rise : {0.0, 0.5, 20.0, 300.0}) {
    event::StaticLimit limit(kLaw);
    limit.start(rise);
    const double time = std::min(limit.reach(), 1e-3), tau = 2e-4;
    std::array<double, 25> series{};
    limit.series(tau, time, series);
    for (const double theta : {0.0, 0.3, 1.0}) {
      double sum = 0.0;
      for (std::size_t p = series.size(); p-- > 0;) sum = sum * theta + series[p];
      EXPECT_NEAR(sum, limit.at(tau + theta * time), 1e-15) << rise;
    }
  }
}

}  // namespace event_level
}  // namespace
}  // namespace modcal::modal_event_thermal_test
