// The string without switches against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "libsim/dynamics/fixed_step/fixed_step.hpp"
#include "libsim/dynamics/friction/friction_law.hpp"
#include "libsim/dynamics/scene/scene.hpp"
#include "libsim/model/damping.hpp"
#include "libsim/model/transfer.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::linear_string_test {
namespace {

ModalExact exact_with(double step) { return ModalExact({.time_step = step}); }

// A bow so fast that the string always slides under a constant force μ F_N.
Scene constant_force_scene(double force) {
  Scene scene = paper_scene();
  scene.bow.velocity = 1000.0;
  scene.bow.normal_force = 1.0;
  scene.friction = Choice<FrictionLaw>::of<CoulombExponential>(
      "coulomb_exponential",
      CoulombExponential::Options{.static_coefficient = force, .dynamic_coefficient = force});
  return scene;
}

TEST(ModalExact, FreeDecayOfEveryModeIsTheClosedForm) {
  Scene scene = paper_scene();
  scene.string.modes = 8;
  scene.bow.normal_force = 0.0;
  scene.duration = 0.2;
  for (std::size_t n = 1; n <= 8; ++n) {
    scene.initial.displacement.push_back(1e-3 / static_cast<double>(n * n));
    scene.initial.velocity.push_back(0.1 / static_cast<double>(n));
  }
  const Simulation run = exact_with(1e-5).simulate(scene, 10000.0, OutputRequest::all());
  const ModalBasis basis = make_modal_basis(scene.string);
  const auto shape = basis.shape_at(scene.bow.position);
  double scale = 0.0;
  for (const double y : run.displacement.samples) scale = std::max(scale, std::abs(y));
  for (std::size_t k = 0; k < run.displacement.size(); k += 37) {
    const double t = static_cast<double>(k) / 10000.0;
    double expected = 0.0;
    for (std::size_t n = 0; n < 8; ++n) {
      const double decay = basis.zeta[n] * basis.omega[n];
      const double damped = basis.omega[n] * std::sqrt(1 - basis.zeta[n] * basis.zeta[n]);
      const double q = scene.initial.displacement[n];
      const double p = scene.initial.velocity[n];
      expected += shape[n] * std::exp(-decay * t) *
                  (q * std::cos(damped * t) + (p + decay * q) / damped * std::sin(damped * t));
    }
    // 20 000 products of modulus ≤ 1, each with a few roundings of 1.1e-16.
    EXPECT_NEAR(run.displacement.samples[k], expected, 20000 * 5e-16 * scale);
  }
}

// A pluck with the bow off the string: every mode, those with a node at the contact included, rings
// down as in the closed form, and the reactions show it.
TEST(Simulators, APluckedStringDecaysFreely) {
  Scene scene = paper_scene();  // x_c = L/11: modes 11, 22, 33 and 44 have a node there
  scene.bow.normal_force = 0.0;
  scene.duration = 0.05;
  scene.start = Choice<InitialMotion>::of<Pluck>(
      "pluck", Pluck::Options{.position = 0.07, .displacement = 2e-3, .width = 4e-3});
  const ModalBasis basis = make_modal_basis(scene.string);
  const ModalState start = initial_state(scene, basis);
  const auto right = reaction_gains(basis, End::kRight);
  const Simulation run = exact_with(1e-5).simulate(scene, 50000.0, OutputRequest::all());
  double scale = 0.0;
  for (const double r : run.right_reaction.samples) scale = std::max(scale, std::abs(r));
  EXPECT_EQ(run.modes_moved, 49u);  // 0.07 m = 7 L/33 is a node of mode 33, which rests
  for (std::size_t k = 0; k < run.right_reaction.size(); k += 13) {
    const double t = static_cast<double>(k) / 50000.0;
    double expected = 0.0;
    for (std::size_t n = 0; n < 50; ++n) {
      const double decay = basis.zeta[n] * basis.omega[n];
      const double damped = basis.omega[n] * std::sqrt(1 - basis.zeta[n] * basis.zeta[n]);
      expected += right[n] * start.displacement[n] * std::exp(-decay * t) *
                  (std::cos(damped * t) + decay / damped * std::sin(damped * t));
    }
    // 5000 products of modulus ≤ 1 a mode and 50 modes, each with a few roundings of 1.1e-16.
    EXPECT_NEAR(run.right_reaction.samples[k], expected, 5000 * 5e-16 * scale);
    EXPECT_EQ(run.force.samples[k], 0.0);
  }
}

TEST(Simulators, AConstantForceDeflectsTheStringStatically) {
  Scene scene = constant_force_scene(0.3);
  scene.string.damping =
      Choice<DampingLaw>::of<ConstantDamping>("constant", ConstantDamping::Options{0.3});
  scene.duration = 0.2;
  const ModalBasis basis = make_modal_basis(scene.string);
  const FrequencyGrid static_grid{.spacing = 1.0, .bins = 1};
  const double receptance = contact_receptance(basis, scene.bow.position, static_grid)[0].real();
  const double left =
      reaction_transfer(basis, scene.bow.position, End::kLeft, static_grid)[0].real();
  for (const char* name : {"modal_exact", "newmark_explicit"}) {
    const Simulation run =
        Choice<Simulator>(name).make()->simulate(scene, 51200.0, OutputRequest::all());
    // After 0.2 s the slowest mode has decayed by exp(−0.3·2π·196·0.2) = 1e-32: rounding is left.
    EXPECT_NEAR(run.displacement.samples.back() / (0.3 * receptance), 1.0, 1e-12) << name;
    EXPECT_NEAR(run.left_reaction.samples.back() / (0.3 * left), 1.0, 1e-12) << name;
  }
}

TEST(ModalExact, ReactionToAForceStepHasTheTransferFunctionAsItsLaplaceTransform) {
  Scene scene = constant_force_scene(0.3);
  scene.string.modes = 5;
  scene.duration = 0.3;
  const double rate = 1e6;
  const Simulation run = exact_with(1e-6).simulate(scene, rate, OutputRequest::all());
  const ModalBasis basis = make_modal_basis(scene.string);
  const double sigma = 120.0;  // exp(−σT) = 2e-16: the record's end does not matter
  for (const double omega : {0.0, 500.0, 1231.5, 6000.0}) {
    const FrequencyGrid grid{.spacing = omega, .bins = 2, .sigma = sigma};
    for (const End end : {End::kLeft, End::kRight}) {
      const Signal& reaction = end == End::kLeft ? run.left_reaction : run.right_reaction;
      const Complex s{sigma, omega};
      Complex transform = 0.0;
      // Simpson's rule: error of (|s| Δt)⁴/180 ≈ 1e-11 of the integral of |R|.
      for (std::size_t k = 0; k + 2 < reaction.size(); k += 2) {
        for (std::size_t j = 0; j < 3; ++j) {
          const double weight = (j == 1 ? 4.0 : 1.0) / (3.0 * rate);
          transform +=
              weight * reaction.samples[k + j] * std::exp(-s * (static_cast<double>(k + j) / rate));
        }
      }
      const Complex expected =
          reaction_transfer(basis, scene.bow.position, end, grid)[omega > 0.0 ? 1 : 0] * 0.3 / s;
      EXPECT_LT(std::abs(transform - expected), 1e-9 * std::abs(expected) + 1e-12)
          << "omega " << omega;
    }
  }
}

}  // namespace
}  // namespace modcal::linear_string_test
