// What simulators leave out: each skip against a computation that does not skip.
#include "libsim/dynamics/plan.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "libsim/dynamics/event/modal_event.hpp"
#include "libsim/dynamics/fixed_step/contact_rule.hpp"
#include "libsim/dynamics/fixed_step/fixed_step.hpp"
#include "libsim/dynamics/friction/friction_law.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::plan_test {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr double kRate = 51200.0;

// The bow at L/11: modes 11, 22, 33 and 44 have a node there.
Scene short_scene() {
  Scene scene = paper_scene();
  scene.duration = 0.02;
  return scene;
}

double error_by_stride(const Signal& a, const Signal& b, std::size_t stride = 1) {
  EXPECT_EQ((a.size() - 1) / 1, (b.size() - 1) / stride);
  double error = 0.0, power = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    error += std::pow(a.samples[i] - b.samples[i * stride], 2);
    power += std::pow(b.samples[i * stride], 2);
  }
  return std::sqrt(error / power);
}

std::vector<std::pair<std::string, std::shared_ptr<const Simulator>>> simulators() {
  std::vector<std::pair<std::string, std::shared_ptr<const Simulator>>> all;
  for (const auto& entry : Simulator::registry()) {
    all.emplace_back(entry.name, Choice<Simulator>(entry.name).make());
  }
  return all;
}

// Errors grow from rounding (1e-16) by the switches' sensitivity: 9 digits are left of 20 ms.
TEST(Skipping, ModesAtANodeChangesNoOutput) {
  const Scene scene = short_scene();
  const Scene carried = with_nodes_carried(scene);
  for (const auto& [name, simulator] : simulators()) {
    const Simulation skipping = simulator->simulate(scene, kRate, OutputRequest::all());
    const Simulation whole = simulator->simulate(carried, kRate, OutputRequest::all());
    EXPECT_EQ(skipping.modes_moved, 46u) << name;
    EXPECT_EQ(whole.modes_moved, 50u) << name;
    EXPECT_EQ(skipping.releases, whole.releases) << name;
    EXPECT_LT(error_by_stride(skipping.displacement, whole.displacement), 1e-9) << name;
    EXPECT_LT(error_by_stride(skipping.velocity, whole.velocity), 1e-9) << name;
    EXPECT_LT(error_by_stride(skipping.force, whole.force), 1e-9) << name;
    EXPECT_LT(error_by_stride(skipping.left_reaction, whole.left_reaction), 1e-9) << name;
    EXPECT_LT(error_by_stride(skipping.right_reaction, whole.right_reaction), 1e-9) << name;
  }
}

TEST(Skipping, OutputsNobodyReadsChangesNoOther) {
  const Scene scene = short_scene();
  for (const auto& entry : simulators()) {
    SCOPED_TRACE(entry.first);
    const Simulator& simulator = *entry.second;
    const Simulation all = simulator.simulate(scene, kRate, OutputRequest::all());
    const auto alone = [&](OutputRequest outputs, Signal Simulation::*signal) {
      const Simulation run = simulator.simulate(scene, kRate, outputs);
      EXPECT_LT(error_by_stride(run.*signal, all.*signal), 1e-9);
      std::size_t kept = 0;
      for (const Signal* each : {&run.displacement, &run.velocity, &run.force, &run.left_reaction,
                                 &run.right_reaction}) {
        kept += each->size();
      }
      EXPECT_EQ(kept, all.force.size());
    };
    alone({.displacement = true}, &Simulation::displacement);
    alone({.velocity = true}, &Simulation::velocity);
    alone({.force = true}, &Simulation::force);
    alone({.left_reaction = true}, &Simulation::left_reaction);
    alone({.right_reaction = true}, &Simulation::right_reaction);
  }
}

// The same steps with a sample at every one.
TEST(Skipping, OutputsBetweenSamplesChangesNoSample) {
  const Scene scene = short_scene();
  const auto compare = [&](const Simulator& simulator, std::size_t stride) {
    const Simulation few = simulator.simulate(scene, kRate, OutputRequest::all());
    Scene longer = scene;  // to the step of the last sample
    longer.duration =
        (static_cast<double>(few.force.size() - 1) * static_cast<double>(stride) + 1) /
        (kRate * static_cast<double>(stride));
    const Simulation every =
        simulator.simulate(longer, kRate * static_cast<double>(stride), OutputRequest::all());
    ASSERT_EQ(every.force.size(), (few.force.size() - 1) * stride + 1);
    EXPECT_LT(error_by_stride(few.velocity, every.velocity, stride), 1e-9);
    EXPECT_LT(error_by_stride(few.force, every.force, stride), 1e-9);
    EXPECT_LT(error_by_stride(few.left_reaction, every.left_reaction, stride), 1e-9);
  };
  compare(ModalEvent({.max_step = 0.25 / kRate}), 4);
  compare(ModalExact({.time_step = 1.0 / (10.0 * kRate)}), 10);
  compare(NewmarkExplicit({.time_step = 1.0 / (10.0 * kRate)}), 10);
}

// Counts how often it is evaluated.
struct CountingLaw {
  using Point = ExponentialSliding::Point;
  ExponentialSliding law{.dynamic_force = 0.2, .force_drop = 0.2, .decay = 5.0};
  int* calls = nullptr;
  Point at(double speed) const {
    ++*calls;
    return law.at(speed);
  }
  double steepest_fall() const { return law.steepest_fall(); }
};

TEST(Skipping, TheFrictionLawIsNotEvaluatedDuringAdherence) {
  int calls = 0;
  const ContactParameters contact{
      .bow_velocity = 0.1, .static_limit = 0.4, .stiffness = 1e5, .damping = 5.0};
  ContactRule<CountingLaw> rule(contact, CountingLaw{.calls = &calls}, 1e-6, 0.0, 0.1);
  const int at_start = calls;
  // The string moves with the bow, a micrometre ahead.
  for (std::uint64_t k = 1; k <= 1000; ++k) {
    const double force = rule.explicit_force(0.1, 0.1 * 1e-6 * static_cast<double>(k) + 1e-6, k);
    EXPECT_NEAR(force, -0.1, 1e-9);
  }
  EXPECT_EQ(calls, at_start);
  rule.explicit_force(0.1, 1.0, 1001);  // released
  EXPECT_GT(calls, at_start);
}

// Torsion so stiff that it moves nothing is torsion left out; mode 11 has a node at the contact.
// modal_event steps otherwise under modes of other frequencies: its own error at its default step,
// below 1e-6, takes the place of rounding.
TEST(Skipping, TorsionThatIsOffChangesNoOutput) {
  const Scene scene = short_scene();
  Scene stiff = scene;
  stiff.torsion.present = true;
  stiff.torsion.impedance_ratio = 1e16;
  for (const auto& [name, simulator] : simulators()) {
    const Simulation off = simulator->simulate(scene, kRate, OutputRequest::all());
    const Simulation on = simulator->simulate(stiff, kRate, OutputRequest::all());
    const double tolerance = name == "modal_event" ? 1e-6 : 1e-9;
    EXPECT_EQ(on.modes_moved, off.modes_moved + 19) << name;
    EXPECT_EQ(on.releases, off.releases) << name;
    EXPECT_LT(error_by_stride(off.velocity, on.velocity), tolerance) << name;
    EXPECT_LT(error_by_stride(off.force, on.force), tolerance) << name;
    EXPECT_LT(error_by_stride(off.right_reaction, on.right_reaction), tolerance) << name;
  }
}

// A temperature that does not change the coefficient is a temperature left out, and three points in
// one place are a width left out: both take the general loop, the scene itself the fast one.
TEST(Skipping, TemperatureAndWidthThatAreOffChangeNoOutput) {
  Scene scene = short_scene();
  CoulombExponential::Options even;
  even.static_coefficient = even.dynamic_coefficient = 0.3;
  scene.friction = Choice<FrictionLaw>::of<CoulombExponential>("coulomb_exponential", even);
  Scene warm = scene, wide = scene;
  Thermal::Options same;
  same.cold_coefficient = same.hot_coefficient = 0.3;
  warm.friction = Choice<FrictionLaw>::of<Thermal>("thermal", same);
  wide.bow.points = 3;
  for (const char* name : {"modal_exact", "newmark_explicit"}) {
    const auto simulator = Choice<Simulator>(name).make();
    const Simulation off = simulator->simulate(scene, kRate, OutputRequest::all());
    EXPECT_GT(off.releases, 0u);
    for (const Scene& with : {warm, wide}) {
      const Simulation on = simulator->simulate(with, kRate, OutputRequest::all());
      EXPECT_LT(error_by_stride(off.velocity, on.velocity), 1e-7) << name;
      EXPECT_LT(error_by_stride(off.force, on.force), 1e-7) << name;
      EXPECT_LT(error_by_stride(off.left_reaction, on.left_reaction), 1e-7) << name;
    }
  }
}

TEST(SimulationPlan, SimulatesNoMoreThanTheRecord) {
  Scene scene = short_scene();
  scene.duration = 1e-3;  // less than what is simulated in no time
  const SimulationPlan plan = plan_simulation(scene, ModalEvent({}), kRate, OutputRequest::all());
  EXPECT_EQ(plan.piece, scene.duration);
}

TEST(SimulationPlan, NamesWhatIsLeftOut) {
  const OutputRequest reactions{.left_reaction = true, .right_reaction = true};
  const SimulationPlan plan = plan_simulation(short_scene(), ModalEvent({.max_step = 0.25 / kRate}),
                                              kRate, reactions, 0.02);
  EXPECT_EQ(plan.modes, 50u);
  EXPECT_EQ(plan.modes_moved, 46u);
  EXPECT_EQ(plan.samples, 1024u);
  EXPECT_DOUBLE_EQ(plan.time_step, 0.25 / kRate);
  EXPECT_GE(plan.steps_per_second, 4.0 * kRate * (1.0 - 1.0 / 50.0));
  EXPECT_GT(plan.seconds(1.0), 0.0);
  EXPECT_THAT(plan.skips, Contains(AllOf(Field(&Skip::what, "modes 11, 22, 33, 44"),
                                         Field(&Skip::reason, HasSubstr("node")))));
  EXPECT_THAT(plan.skips, Contains(Field(&Skip::what, "output y, v, f_c")));
  EXPECT_THAT(plan.skips, Contains(AllOf(Field(&Skip::what, "outputs between the samples"),
                                         Field(&Skip::reason, HasSubstr("4 steps")))));
  EXPECT_THAT(plan.skips, Contains(Field(&Skip::what, HasSubstr("friction law"))));
  EXPECT_THAT(plan.skips, Contains(Field(&Skip::what, "torsion")));
  EXPECT_THAT(plan.skips, Contains(AllOf(Field(&Skip::what, "temperature of the contact"),
                                         Field(&Skip::note, HasSubstr("measured")))));
  EXPECT_THAT(plan.skips, Contains(AllOf(Field(&Skip::what, "width of the bow"),
                                         Field(&Skip::note, HasSubstr("does not follow")))));
  for (const Skip& skip : plan.skips) EXPECT_THAT(skip.note, Not(IsEmpty()));
}

TEST(SimulationPlan, NamesNothingThatIsNotLeftOut) {
  Scene scene = short_scene();
  scene.bow.position = 0.0317;
  scene.bow.normal_force = 0.0;  // no contact: no adherence either
  const SimulationPlan plan =
      plan_simulation(scene, ModalEvent({}), kRate, OutputRequest::all(), 0.01);
  EXPECT_THAT(plan.skips, IsEmpty());
}

TEST(SimulationPlan, DoesNotNameWhatTheSceneAsksFor) {
  Scene scene = short_scene();
  scene.torsion.present = true;
  scene.friction = Choice<FrictionLaw>("thermal");
  scene.bow.points = 2;
  const SimulationPlan plan =
      plan_simulation(scene, ModalExact({}), kRate, OutputRequest::all(), 0.01);
  for (const char* name : {"torsion", "temperature", "width"}) {
    EXPECT_THAT(plan.skips, Not(Contains(Field(&Skip::what, HasSubstr(name)))));
  }
}

}  // namespace
}  // namespace modcal::plan_test
