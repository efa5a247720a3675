#include "benchmarks/stress/energy_account.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "libsim/base/error.hpp"
#include "libsim/dynamics/fixed_step/fixed_step.hpp"
#include "libsim/dynamics/friction/friction_law.hpp"
#include "libsim/dynamics/gestures/gesture.hpp"
#include "libsim/dynamics/scene/contact_modes.hpp"
#include "libsim/dynamics/scene/scene.hpp"
#include "libsim/model/damping.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::energy_account_test {
namespace {

Scene damped_scene() {
  Scene scene = paper_scene();
  scene.duration = 0.02;
  scene.string.damping =
      Choice<DampingLaw>::of<ConstantDamping>("constant", ConstantDamping::Options{0.01});
  return scene;
}

EnergyAccount account_of(const Scene& scene, const Simulator& simulator, double step,
                         ForceHold hold) {
  const Simulation run = simulator.simulate(scene, 1.0 / step, OutputRequest::all());
  return audit_energy(scene, run, hold);
}

void expect_balanced(const EnergyAccount& energy) {
  EXPECT_LT(std::abs(energy.string_residual()), energy.rounding);
  EXPECT_LT(energy.rounding, 1e-8 * energy.throughput);
  EXPECT_GT(energy.dissipated, 0.01 * energy.throughput);
  EXPECT_GT(energy.stored, 0.01 * energy.throughput);
  EXPECT_GT(energy.contact_loss(), 0.0);
  EXPECT_NEAR(energy.bow_work, energy.string_work + energy.contact_loss(), energy.rounding);
}

TEST(EnergyAudit, ClosesForTheFixedStepSchemes) {
  const Scene scene = damped_scene();
  expect_balanced(
      account_of(scene, NewmarkExplicit({.time_step = 1e-6}), 1e-6, ForceHold::kLagged));
  expect_balanced(account_of(scene, ModalExact({.time_step = 1e-6}), 1e-6, ForceHold::kLinear));
}

// 30 rad of the top mode in a step of 0.5 ms: both ways of integrating a step are taken.
TEST(EnergyAudit, ClosesOverLongSteps) {
  Scene scene = damped_scene();
  scene.bow.normal_force = 0.02;
  scene.duration = 0.2;
  const EnergyAccount energy =
      account_of(scene, ModalExact({.time_step = 5e-4}), 5e-4, ForceHold::kLinear);
  EXPECT_LT(std::abs(energy.string_residual()), energy.rounding);
  EXPECT_LT(energy.rounding, 1e-8 * energy.throughput);
}

// A free decay loses what it stored, in closed form for one mode:
// E(t) = E(0) e^{−2ζωt} (1 + terms of order ζ that vanish after whole periods of ω_d).
TEST(EnergyAudit, OfAFreeDecayIsTheClosedForm) {
  Scene scene = damped_scene();
  scene.string.modes = 1;
  scene.bow.normal_force = 0.0;
  scene.initial.displacement = {1e-3};
  scene.initial.velocity = {0.0};
  const ModalBasis basis = make_modal_basis(scene.string);
  const double damped = basis.omega[0] * std::sqrt(1.0 - 1e-4);
  const double step = 2.0 * 3.141592653589793 / damped / 100.0;
  scene.duration = 501.0 * step;  // samples at 0 … 5 periods
  const EnergyAccount energy =
      account_of(scene, ModalExact({.time_step = step}), step, ForceHold::kLinear);
  const double start = 0.5 * basis.mass[0] * std::pow(basis.omega[0] * 1e-3, 2);
  const double left = std::exp(-2.0 * 0.01 * basis.omega[0] * 500.0 * step);
  EXPECT_NEAR(energy.stored, start * (left - 1.0), 1e-11 * start);
  EXPECT_NEAR(energy.dissipated, start * (1.0 - left), 1e-11 * start);
  EXPECT_EQ(energy.string_work, 0.0);
}

TEST(EnergyAudit, SeesAVelocityThatTheForceDoesNotExplain) {
  const Scene scene = damped_scene();
  Simulation run = ModalExact({.time_step = 1e-6}).simulate(scene, 1e6, OutputRequest::all());
  for (std::size_t k = 5000; k < run.velocity.size(); ++k) run.velocity.samples[k] *= 1.0 + 1e-6;
  const EnergyAccount energy = audit_energy(scene, run, ForceHold::kLinear);
  EXPECT_GT(std::abs(energy.string_residual()), 10.0 * energy.rounding);
}

// Whatever the bow does and the contact is made of, the modes have taken what the forces gave them:
// scenes of the stability map's bows and contacts at the ends of what the schemes resolve.
Choice<Gesture> table(std::vector<double> times, std::vector<double> factors) {
  return Choice<Gesture>::of<TableGesture>(
      "table", TableGesture::Options{std::move(times), std::move(factors)});
}

std::vector<Scene> unsteady_scenes() {
  std::vector<Scene> scenes(6, damped_scene());
  scenes[0].bow.velocity_gesture = table({0.006, 0.01}, {1.0, -1.0});
  scenes[1].bow.force_gesture = table({0.006, 0.008, 0.012, 0.014}, {1.0, 0.0, 0.0, 1.0});
  scenes[2].torsion.present = true;
  scenes[3].friction = Choice<FrictionLaw>("thermal");
  scenes[4].friction = Choice<FrictionLaw>("elasto_plastic");
  scenes[5].start = Choice<InitialMotion>::of<Pluck>(
      "pluck", Pluck::Options{.position = 0.07, .displacement = 1e-3, .width = 0.0});
  return scenes;
}

TEST(EnergyAudit, ClosesWhateverTheBowAndTheContactDo) {
  std::size_t index = 0;
  for (const Scene& scene : unsteady_scenes()) {
    for (const bool is_explicit : {false, true}) {
      const EnergyAccount energy =
          is_explicit
              ? account_of(scene, NewmarkExplicit({.time_step = 1e-6}), 1e-6, ForceHold::kLagged)
              : account_of(scene, ModalExact({.time_step = 1e-6}), 1e-6, ForceHold::kLinear);
      EXPECT_LT(std::abs(energy.string_residual()), energy.rounding) << index << is_explicit;
      EXPECT_LT(energy.rounding, 1e-8 * (energy.throughput + energy.largest_stored)) << index;
      EXPECT_GT(energy.dissipated, 0.0) << index;
      EXPECT_GT(energy.contact_loss(), 0.0) << index << is_explicit;
    }
    ++index;
  }
}

// A bow that turns round pulls against the work it did: its work is that of the travel, not of
// v_bow(0) t. The force is constant, so that both have closed forms.
TEST(EnergyAudit, TheBowWorksAlongItsTravel) {
  Scene scene = damped_scene();
  scene.bow.velocity = 100.0;  // slides forwards throughout
  CoulombExponential::Options constant;
  constant.static_coefficient = constant.dynamic_coefficient = 0.3;
  scene.friction = Choice<FrictionLaw>::of<CoulombExponential>("coulomb_exponential", constant);
  scene.bow.velocity_gesture = table({0.0, 0.01, 0.02}, {1.0, 0.5, 1.0});
  const EnergyAccount energy =
      account_of(scene, ModalExact({.time_step = 1e-6}), 1e-6, ForceHold::kLinear);
  // The last sample is at 19.999 ms, where the bow has come 1.5 m less 1e-6 s · 100 m/s.
  const double travel = 1.5 - 1e-6 * 100.0 * (1.0 - 0.5 * 0.5e-4);
  EXPECT_NEAR(energy.bow_work, 0.3 * travel, 1e-10);
  EXPECT_NEAR(energy.contact_loss(), energy.bow_work - energy.string_work, 1e-12);
}

// Three points: each drives the modes with its own force, and only all of them together balance.
TEST(EnergyAudit, ClosesForEveryPointOfAWideBow) {
  Scene scene = damped_scene();
  scene.bow.width = 5e-3;
  scene.bow.points = 3;
  for (const bool is_explicit : {false, true}) {
    std::vector<PointMotion> points;
    const Simulation run =
        simulate_fixed_step(scene, 1e6, OutputRequest::all(), {}, 1e-6,
                            is_explicit ? kNewmarkScheme : kExactScheme, &points);
    ASSERT_FALSE(run.diverged_at);
    const ForceHold hold = is_explicit ? ForceHold::kLagged : ForceHold::kLinear;
    std::vector<PointRecord> records;
    for (const PointMotion& point : points) {
      records.push_back({point.displacement, point.velocity, point.force});
    }
    const BowMotion bow = bow_motion(scene.bow, scene.duration);
    const LineModes modes = scene_line_modes(scene);
    const EnergyAccount energy = audit_energy(modes, bow, records, 1e6, hold);
    EXPECT_LT(std::abs(energy.string_residual()), energy.rounding) << is_explicit;
    EXPECT_LT(energy.rounding, 1e-8 * energy.throughput);
    EXPECT_GT(energy.contact_loss(), 0.0);
    std::swap(records[0], records[2]);
    EXPECT_GT(std::abs(audit_energy(modes, bow, records, 1e6, hold).string_residual()),
              10.0 * energy.rounding);
    EXPECT_THROW(audit_energy(scene, run, hold), InvalidInput);
    EXPECT_THROW(audit_energy(modes, bow, {records.data(), 2}, 1e6, hold), InvalidInput);
  }
}

TEST(EnergyAudit, NeedsItsThreeSignals) {
  const Scene scene = damped_scene();
  const Simulation run =
      ModalExact({.time_step = 1e-6}).simulate(scene, 1e6, {.velocity = true, .force = true});
  EXPECT_THROW(audit_energy(scene, run, ForceHold::kLinear), InvalidInput);
}

}  // namespace
}  // namespace modcal::energy_account_test
