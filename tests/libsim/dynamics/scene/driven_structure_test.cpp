// A structure under a bow against the string it is a table of, closed forms, and what is refused.
#include "libsim/dynamics/scene/driven_structure.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "libsim/model/transfer.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"
#include "tests/libsim/dynamics/simulators/compared_runs.hpp"
#include "tests/refusal.hpp"

namespace modcal::driven_structure_test {
namespace {

constexpr double kRate = 40000.0;

Scene string_scene() {
  Scene scene = paper_scene();
  scene.string.modes = 30;
  scene.bow.position = 0.0314;  // no node of these modes
  scene.duration = 0.1;
  return scene;
}

// Both reactions and the displacement at the contact.
DrivenStructure table_of(const Scene& scene) {
  const ModalBasis basis = make_modal_basis(scene.string);
  DrivenStructure structure{string_model(basis, scene.bow.position), {}};
  const std::vector<double> shape = basis.shape_at(scene.bow.position);
  for (std::size_t n = 0; n < basis.size(); ++n) {
    structure.drive.push_back(shape[n] * shape[n] / basis.mass[n]);
  }
  return structure;
}

void expect_equal(const std::vector<double>& found, const std::vector<double>& expected,
                  double tolerance = 1e-12) {
  ASSERT_EQ(found.size(), expected.size());
  const auto size = [](double x) { return std::abs(x); };
  const double most = size(*std::ranges::max_element(expected, {}, size));
  // Constants of 30 modes with three roundings each that are summed in another order: 30·4 eps of
  // terms that are a few times the sum at most.
  for (std::size_t j = 0; j < found.size(); ++j) {
    ASSERT_NEAR(found[j], expected[j], tolerance * most) << j;
  }
}

// `rounding`: of the motion; 0: the contact sees the same numbers, bit by bit.
void expect_the_string(const Simulator& simulator, const Scene& scene, double rounding = 0.0) {
  const Simulation string = simulator.simulate(scene, kRate, OutputRequest::all());
  const StructureSimulation found = simulate_structure(simulator, scene, table_of(scene), kRate);
  EXPECT_GT(string.releases, 3u);
  EXPECT_EQ(found.contact.releases, string.releases);
  expect_equal(found.contact.force.samples, string.force.samples, rounding);
  expect_equal(found.contact.velocity.samples, string.velocity.samples, rounding);
  ASSERT_EQ(found.sensors.size(), 3u);
  const double read = std::max(rounding, 1e-12);
  expect_equal(found.sensors[0], string.left_reaction.samples, read);
  expect_equal(found.sensors[1], string.right_reaction.samples, read);
  expect_equal(found.sensors[2], string.displacement.samples, read);
}

TEST(DrivenStructure, AStringAsATableIsTheString) {
  const Scene scene = string_scene();
  expect_the_string(ModalEvent({}), scene);
  expect_the_string(ModalExact({.time_step = 1e-6}), scene);
  expect_the_string(NewmarkExplicit({.time_step = 1e-6}), scene);
}

// Under a gesture the fixed-step schemes take their general loop, which carries φ_n apart from
// 1/m_n: other roundings, 1e-16 of each of 1e5 steps, and each of 40 switches carries them over.
TEST(DrivenStructure, AndUnderABowThatChanges) {
  Scene scene = string_scene();
  scene.bow.force_gesture =
      Choice<Gesture>::of<RampGesture>("ramp", RampGesture::Options{.from = 0.5, .to = 1.5});
  expect_the_string(ModalEvent({}), scene);
  expect_the_string(ModalExact({.time_step = 1e-6}), scene, 40 * 1e5 * 1e-16);
  expect_the_string(NewmarkExplicit({.time_step = 1e-6}), scene, 40 * 1e5 * 1e-16);
}

// Two modes, the contact at a node of the second one; all kinds of sensors, complex constants.
DrivenStructure two_modes() {
  DrivenStructure structure;
  ModalModel& model = structure.model;
  model.poles = {{2.0 * std::numbers::pi * 100.0, 0.01}, {2.0 * std::numbers::pi * 230.0, 0.03}};
  model.sensors = {SensorKind::kDisplacement, SensorKind::kVelocity, SensorKind::kAcceleration,
                   SensorKind::kForce, SensorKind::kStrain};
  for (int k = 0; k < 5; ++k) {
    model.constants.insert(model.constants.end(), {2.0 - k, 0.5 + k});
    model.quadrature.insert(model.quadrature.end(), {0.3 * k - 0.4, 0.2});
    model.residuals.push_back({.below = 0.7, .constant = 1e-4});
  }
  model = simulated_part(std::move(model));
  structure.drive = {3.0, 0.0};
  return structure;
}

// Response to a force of 1 N from t = 0 on: residues of H(s)/s.
double step_response(const ModalModel& model, std::size_t sensor, double t) {
  const int p = power_of_s(model.sensors[sensor]);
  double sum = p == 2 ? model.residuals[sensor].below : p == 0 ? 1e-4 : 0.0;
  for (std::size_t n = 0; n < model.poles.size(); ++n) {
    const auto [omega, zeta] = model.poles[n];
    const double real = model.constant(sensor, n);
    const double turned = model.quadrature[sensor * model.poles.size() + n];
    const Complex pole(-zeta * omega, omega * std::sqrt(1.0 - zeta * zeta));
    const Complex numerator = real + turned * (p == 0 ? pole / omega : -omega / pole);
    const Complex residue = std::pow(pole, p - 1) * numerator / (pole - std::conj(pole));
    sum += 2.0 * (residue * std::exp(pole * t)).real();
    // At s = 0.
    sum += p == 0 ? real / (omega * omega) : p == 1 ? -turned / omega : 0.0;
  }
  return sum;
}

// A temperature that changes nothing takes the fixed-step schemes' general loop.
void expect_answers_to_a_step(const Choice<FrictionLaw>& friction) {
  Scene scene;
  scene.bow.velocity = 1000.0;  // so fast that the contact always slides
  scene.friction = friction;
  scene.duration = 0.05;
  const DrivenStructure structure = two_modes();
  const auto expect_steps = [&](const Simulator& simulator, double tolerance) {
    const StructureSimulation found = simulate_structure(simulator, scene, structure, kRate);
    ASSERT_EQ(found.sensors.size(), 5u);
    EXPECT_EQ(found.contact.modes_moved, 2u);
    for (std::size_t k = 0; k < 5; ++k) {
      double most = 0.0;
      for (const double x : found.sensors[k]) most = std::max(most, std::abs(x));
      for (std::size_t j = 1; j < found.sensors[k].size(); ++j) {
        const double t = static_cast<double>(j) / kRate;
        ASSERT_NEAR(found.sensors[k][j], 0.8 * step_response(structure.model, k, t),
                    tolerance * most)
            << k << " at " << t;
      }
    }
  };
  // 2000 and 50 000 products of modulus 1, a few roundings each.
  expect_steps(ModalEvent({}), 2000 * 1e-15);
  expect_steps(ModalExact({.time_step = 1e-6}), 50000 * 1e-15);
  // The trapezoidal rule is off by ω³h²t/12 = 1.3e-5 of a phase at the end, the force of the step
  // before comes 1 µs late: ωh = 1.4e-3.
  expect_steps(NewmarkExplicit({.time_step = 1e-6}), 2e-3);
}

TEST(DrivenStructure, EverySensorAnswersAStepOfTheForceAsItsTransferFunction) {
  expect_answers_to_a_step(Choice<FrictionLaw>::of<CoulombExponential>(
      "coulomb_exponential",
      CoulombExponential::Options{.static_coefficient = 0.8, .dynamic_coefficient = 0.8}));
  Thermal::Options even;
  even.cold_coefficient = even.hot_coefficient = 0.8;
  expect_answers_to_a_step(Choice<FrictionLaw>::of<Thermal>("thermal", even));
}

// What the friction force does on the contact is what the modes hold and what their dampers take,
// all of it told by sensors of one mode each.
TEST(DrivenStructure, TheEnergyOfStickAndSlipIsAccountedFor) {
  constexpr double kFine = 400000.0;
  DrivenStructure structure;
  structure.model.poles = two_modes().model.poles;
  structure.model.sensors = {SensorKind::kDisplacement, SensorKind::kDisplacement,
                             SensorKind::kVelocity, SensorKind::kVelocity};
  // Each reads the contact's own part in a mode.
  structure.drive = {40.0, 60.0};
  structure.model.constants = {40.0, 0.0, 0.0, 60.0, 40.0, 0.0, 0.0, 60.0};
  Scene scene;
  scene.bow.velocity = 0.01;  // slow enough for the contact to be caught
  scene.duration = 0.5;
  const StructureSimulation found = simulate_structure(ModalEvent({}), scene, structure, kFine);
  ASSERT_EQ(found.sensors.size(), 4u);
  EXPECT_GT(found.contact.releases, 10u);
  const auto& force = found.contact.force.samples;
  const std::size_t samples = force.size();
  const auto power = [&](std::size_t j) {
    double lost = 0.0;
    for (std::size_t n = 0; n < 2; ++n) {
      const auto [omega, zeta] = structure.model.poles[n];
      lost += 2.0 * zeta * omega * std::pow(found.sensors[2 + n][j], 2) / structure.drive[n];
    }
    return std::pair(force[j] * found.contact.velocity.samples[j], lost);
  };
  double work = 0.0, lost = 0.0, held = 0.0;
  for (std::size_t j = 0; j < samples; ++j) {
    const double weight = (j == 0 || j + 1 == samples ? 0.5 : 1.0) / kFine;
    work += weight * power(j).first;
    lost += weight * power(j).second;
  }
  for (std::size_t n = 0; n < 2; ++n) {
    const double omega = structure.model.poles[n].omega;
    held +=
        0.5 / structure.drive[n] *
        (std::pow(found.sensors[2 + n].back(), 2) + std::pow(omega * found.sensors[n].back(), 2));
  }
  EXPECT_GT(held, 0.01 * work);
  // A switch changes the force by 0.4 N at most, somewhere between two samples, at 10 mm/s.
  const double bound = 0.5 * 0.4 * 0.01 / kFine *
                       static_cast<double>(found.contact.releases + found.contact.attachments);
  EXPECT_NEAR(held + lost, work, bound);
  EXPECT_LT(bound, 0.02 * work);  // so that it says something
}

TEST(DrivenStructure, RefusesWhatNoContactDoes) {
  const ModalEvent event({});
  Scene scene;
  const auto refused = [&](DrivenStructure structure) {
    return refusal_of([&] { simulate_structure(event, scene, structure, kRate); });
  };
  DrivenStructure structure = two_modes();
  structure.drive = {3.0, -0.1};
  EXPECT_EQ(refused(structure),
            "phi^2/m of the mode at 230 Hz is -0.1 /kg at the contact: it is no square");
  structure.drive = {0.0, 0.0};
  EXPECT_EQ(refused(structure),
            "no mode moves at the contact: it needs phi^2/m > 0 of one at least");
  structure.drive = {1.0};
  EXPECT_EQ(refused(structure), "1 values at the contact for 2 modes");
  scene.torsion.present = true;
  EXPECT_EQ(refused(two_modes()),
            "torsion is that of a string: leave scene.torsion out for a structure");
}

}  // namespace
}  // namespace modcal::driven_structure_test
