#include "libsim/dynamics/energy_audit.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "libsim/base/error.hpp"
#include "libsim/dynamics/simulators/modal_exact.hpp"
#include "libsim/dynamics/simulators/newmark_explicit.hpp"
#include "libsim/dynamics/simulators/scene_setup.hpp"
#include "libsim/model/constant_damping.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal {
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
  return audit_energy(scene_modes(scene), run, scene.bow.velocity, hold);
}

void expect_balanced(const EnergyAccount& energy) {
  EXPECT_LT(std::abs(energy.residual()), energy.rounding);
  EXPECT_LT(energy.rounding, 1e-8 * energy.throughput);
  EXPECT_GT(energy.dissipated, 0.01 * energy.throughput);
  EXPECT_GT(energy.stored, 0.01 * energy.throughput);
  EXPECT_GT(energy.contact_loss, 0.0);
  EXPECT_NEAR(energy.bow_work, energy.string_work + energy.contact_loss, energy.rounding);
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
  EXPECT_LT(std::abs(energy.residual()), energy.rounding);
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
  const EnergyAccount energy =
      audit_energy(scene_modes(scene), run, scene.bow.velocity, ForceHold::kLinear);
  EXPECT_GT(std::abs(energy.residual()), 10.0 * energy.rounding);
}

TEST(EnergyAudit, NeedsItsThreeSignals) {
  const Scene scene = damped_scene();
  const Simulation run =
      ModalExact({.time_step = 1e-6}).simulate(scene, 1e6, {.velocity = true, .force = true});
  EXPECT_THROW(audit_energy(scene_modes(scene), run, 0.1, ForceHold::kLinear), InvalidInput);
}

}  // namespace
}  // namespace modcal
