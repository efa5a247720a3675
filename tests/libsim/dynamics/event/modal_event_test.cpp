#include "libsim/dynamics/event/modal_event.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "libsim/base/error.hpp"
#include "libsim/dynamics/friction/friction_law.hpp"
#include "libsim/dynamics/scene/scene.hpp"
#include "tests/libsim/dynamics/random_scenes.hpp"
#include "tests/libsim/dynamics/simulators/compared_runs.hpp"
#include "tests/libsim/dynamics/simulators/long_double_twin.hpp"

namespace modcal::modal_event_test {
namespace {

constexpr double kRate = 51200.0;

Simulation run_with(const Scene& scene, const ModalEvent::Options& options = {},
                    double rate = kRate) {
  return event_run(scene, options, rate);
}

Simulation first_part(Simulation run, double duration) {
  for (Signal* signal :
       {&run.displacement, &run.velocity, &run.force, &run.left_reaction, &run.right_reaction}) {
    signal->samples.resize(static_cast<std::size_t>(duration * kRate));
  }
  return run;
}

// The demands on a truth: 1e-5 over the first 50 ms, 1e-4 over 1 s, from the sampling period as
// the step; the reference with 2.5 µs is 1e3 to 1e5 times better (order 8).
TEST(ModalEvent, ThePapersCaseIsConverged) {
  const Scene scene = paper_scene();
  const Simulation run = run_with(scene);
  const Simulation reference = run_with(scene, {.max_step = 2.5e-6});
  ASSERT_FALSE(run.diverged_at) << run.explanation;
  EXPECT_EQ(run.attachments + run.releases, 917u);
  EXPECT_EQ(reference.attachments + reference.releases, 917u);
  EXPECT_LT(worst_error(first_part(run, 0.05), first_part(reference, 0.05)), 1e-5);
  EXPECT_LT(worst_error(run, reference), 1e-4);
}

// Order 2(s − 1) between two steps that see the same switches; kappa falls with the step so that
// the substeps after a release fall with it too, and no step is refined for its tail. Steps chosen
// above the rounding floor (1e-11 over 20 ms); what a step does not share with its half, the cut
// steps beside the switches, leaves 0.3.
TEST(ModalEvent, ConvergesAtTheOrderOfItsNodes) {
  Scene scene = paper_scene();
  scene.duration = 0.02;
  const auto run = [&](std::int64_t nodes, double step) {
    return run_with(
        scene,
        {.nodes = nodes, .max_step = step, .slope_number = 0.7 * step / 2e-5, .tail_ratio = 1e3},
        50000.0);
  };
  const Simulation reference = run(5, 1e-6);
  struct Case {
    std::int64_t nodes;
    double step;
  };
  for (const Case& c : {Case{2, 2.5e-6}, Case{3, 2.5e-6}, Case{4, 2e-5}, Case{5, 2e-5}}) {
    const Simulation coarse = run(c.nodes, c.step), fine = run(c.nodes, c.step / 2.0);
    EXPECT_EQ(coarse.attachments, reference.attachments);
    EXPECT_NEAR(std::log2(relative_error(coarse.velocity, reference.velocity) /
                          relative_error(fine.velocity, reference.velocity)),
                2.0 * static_cast<double>(c.nodes - 1), 0.3)
        << c.nodes << " nodes";
  }
}

// Steps that the powers of their force do not resolve are taken back: a sampling period of 1 ms
// with 5 modes allows steps of 0.12 ms, at which the force is no polynomial of degree 4.
TEST(ModalEvent, RefinesWhereItsForceIsNotResolved) {
  Scene scene = paper_scene();
  scene.string.modes = 5;
  scene.duration = 0.1;
  const auto run = [&](double ratio, double step) {
    return run_with(scene, {.max_step = step, .tail_ratio = ratio}, 1000.0);
  };
  const Simulation reference = run(0.3, 1e-6), free = run(1e3, 1e-3), held = run(0.3, 1e-3);
  EXPECT_GT(held.refined_steps, 4 * free.refined_steps);
  // The tail falls as the fourth power of a step, the error as the eighth.
  EXPECT_LT(worst_error(held, reference), 0.1 * worst_error(free, reference));
}

TEST(ModalEvent, TheFixedStepSchemeApproachesIt) {
  Scene scene = paper_scene();
  scene.duration = 0.02;
  expect_the_fixed_step_limit(scene, 50000.0);
}

TEST(ModalEvent, FollowsTheExtendedPrecisionTwin) {
  Scene scene = paper_scene();
  scene.string.modes = 10;
  scene.duration = 0.008;
  const Simulation run = run_with(scene, {.max_step = 2e-6}, 50000.0);
  const ModalBasis basis = make_modal_basis(scene.string);
  const auto shape = basis.shape_at(scene.bow.position);
  double inverse_mass = 0.0;
  for (std::size_t n = 0; n < 10; ++n) inverse_mass += shape[n] * shape[n] / basis.mass[n];
  LongDoubleTwin twin(basis, scene.bow.position,
                      {.velocity = 0.1,
                       .dynamic_force = 0.2,
                       .force_drop = 0.2,
                       .decay = 5.0,
                       .stiffness = 1e5,
                       .damping = 2.0 * std::sqrt(1e5 / inverse_mass)});
  double error_v = 0.0, error_f = 0.0, error_y = 0.0, size_y = 0.0;
  for (std::size_t k = 0; k < run.velocity.size(); ++k) {
    error_v =
        std::max(error_v, std::abs(static_cast<double>(twin.velocity()) - run.velocity.samples[k]));
    error_f = std::max(error_f, std::abs(static_cast<double>(twin.force()) - run.force.samples[k]));
    error_y = std::max(
        error_y, std::abs(static_cast<double>(twin.displacement()) - run.displacement.samples[k]));
    size_y = std::max(size_y, std::abs(run.displacement.samples[k]));
    for (int i = 0; i < 400; ++i) twin.step(5e-8L);
  }
  EXPECT_GT(twin.switches(), 5);
  // The twin's own error: (3e4 s⁻¹ · 5e-8 s)⁴/120 per radian, 120 rad: 5e-12. The parameters agree
  // to 1e-16; rounding amplified by 1e3 over 8 ms adds 1e-13.
  EXPECT_LT(error_v, 2e-11);
  EXPECT_LT(error_f, 2e-11);
  EXPECT_LT(error_y, 2e-11 * size_y);
}

TEST(ModalEvent, HoldsOnRandomScenes) {
  for (const char* rule : {"literal", "continuous"}) {
    for (std::uint64_t seed = 1; seed <= 18; ++seed) {
      Scene scene = random_scene(seed);
      scene.duration = 0.02;
      const Simulation run = run_with(scene, {.attach = rule});
      const Simulation fine = run_with(scene, {.max_step = 4e-6, .attach = rule});
      ASSERT_FALSE(run.diverged_at) << run.explanation;
      EXPECT_LT(worst_error(run, fine), 1e-3) << rule << " seed " << seed;
    }
  }
}

TEST(ModalEvent, AReversedBowMirrorsTheMotion) {
  Scene scene = paper_scene();
  scene.duration = 0.05;
  const Simulation up = run_with(scene);
  scene.bow.velocity = -scene.bow.velocity;
  const Simulation down = run_with(scene);
  ASSERT_FALSE(down.diverged_at);
  for (std::size_t k = 0; k < up.velocity.size(); ++k) {
    ASSERT_EQ(up.velocity.samples[k], -down.velocity.samples[k]) << k;
    ASSERT_EQ(up.force.samples[k], -down.force.samples[k]) << k;
  }
}

TEST(ModalEvent, ABowAtRestHoldsTheStringWhereItIs) {
  Scene scene = paper_scene();
  scene.bow.velocity = 0.0;
  scene.duration = 0.02;
  const Simulation still = run_with(scene);
  for (const double v : still.velocity.samples) ASSERT_EQ(v, 0.0);

  // Moved gently, the string is held as a linear system: no switch, and it comes to rest, by
  // exp(−0.2·1231·0.2) = 4e-22 of the slowest mode at least.
  scene.duration = 0.2;
  scene.string.damping =
      Choice<DampingLaw>::of<ConstantDamping>("constant", ConstantDamping::Options{0.2});
  scene.initial.displacement.assign(50, 0.0);
  scene.initial.displacement[0] = 1e-6;
  const Simulation held = run_with(scene);
  EXPECT_EQ(held.releases, 0u);
  EXPECT_LT(std::abs(held.velocity.samples.back()), 1e-15 * std::abs(held.velocity.samples[3]));
}

TEST(ModalEvent, FreeDecayIsTheClosedForm) {
  Scene scene = paper_scene();
  scene.string.modes = 8;
  scene.bow.normal_force = 0.0;
  scene.duration = 0.2;
  scene.initial.displacement.assign(8, 1e-3);
  const Simulation run = run_with(scene, {}, 10000.0);
  const ModalBasis basis = make_modal_basis(scene.string);
  const auto shape = basis.shape_at(scene.bow.position);
  for (std::size_t k = 0; k < run.displacement.size(); k += 37) {
    const double t = static_cast<double>(k) / 10000.0;
    double expected = 0.0;
    for (std::size_t n = 0; n < 8; ++n) {
      const double decay = basis.zeta[n] * basis.omega[n];
      const double damped = basis.omega[n] * std::sqrt(1 - basis.zeta[n] * basis.zeta[n]);
      expected += shape[n] * 1e-3 * std::exp(-decay * t) *
                  (std::cos(damped * t) + decay / damped * std::sin(damped * t));
    }
    // 2000 products of modulus ≤ 1 of 8 modes, a few roundings each.
    EXPECT_NEAR(run.displacement.samples[k], expected, 2000 * 8 * 4e-16 * 1e-3);
  }
}

TEST(ModalEvent, ConvergesWithHyperbolicFriction) {
  Scene scene = paper_scene();
  scene.duration = 0.02;
  scene.friction = Choice<FrictionLaw>::of<Hyperbolic>("hyperbolic", Hyperbolic::Options{});
  const Simulation run = run_with(scene), fine = run_with(scene, {.max_step = 2.5e-6});
  ASSERT_FALSE(run.diverged_at) << run.explanation;
  EXPECT_EQ(run.attachments, fine.attachments);
  EXPECT_LT(worst_error(run, fine), 1e-4);
}

// The pluck moves modes with a node at the contact too: they only ring.
TEST(ModalEvent, APluckedStringUnderALiftedBowRingsFreely) {
  Scene scene = paper_scene();
  scene.duration = 0.02;
  scene.start = Choice<InitialMotion>::of<Pluck>("pluck", Pluck::Options{0.1, 1e-3});
  scene.bow.normal_force = 0.0;
  const Simulation event = run_with(scene);
  const Simulation exact =
      ModalExact({.time_step = 1e-5}).simulate(scene, kRate, OutputRequest::all());
  EXPECT_EQ(event.attachments, 0u);
  // Both are exact: 2000 products of modulus ≤ 1.
  EXPECT_LT(relative_error(event.right_reaction, exact.right_reaction), 2000 * 4e-16);
  scene.bow.normal_force = 1.0;
  const Simulation bowed = run_with(scene), fine = run_with(scene, {.max_step = 2.5e-6});
  ASSERT_FALSE(bowed.diverged_at) << bowed.explanation;
  EXPECT_LT(worst_error(bowed, fine), 1e-5);
}

TEST(ModalEvent, SamplesDoNotDependOnWhatElseIsAskedFor) {
  Scene scene = paper_scene();
  scene.duration = 0.02;
  const Simulation all = run_with(scene);
  const Simulation one = ModalEvent({}).simulate(scene, kRate, {.right_reaction = true});
  const Simulation other =
      ModalEvent({}).simulate(scene, kRate, {.displacement = true, .force = true});
  EXPECT_EQ(one.right_reaction.samples, all.right_reaction.samples);
  EXPECT_EQ(other.displacement.samples, all.displacement.samples);
  EXPECT_EQ(other.force.samples, all.force.samples);
  EXPECT_TRUE(one.velocity.samples.empty());
}

TEST(ModalEvent, SlowSamplingDoesNotCoarsenTheMotion) {
  Scene scene = paper_scene();
  scene.duration = 0.05;
  const Simulation fast = run_with(scene);
  const Simulation slow = run_with(scene, {}, kRate / 64.0);
  ASSERT_FALSE(slow.diverged_at) << slow.explanation;
  double error = 0.0, power = 0.0;
  for (std::size_t k = 0; k < slow.velocity.size(); ++k) {
    error += std::pow(slow.velocity.samples[k] - fast.velocity.samples[64 * k], 2);
    power += std::pow(slow.velocity.samples[k], 2);
  }
  EXPECT_LT(std::sqrt(error / power), 1e-5);
}

TEST(ModalEvent, HugeAndTinyInputsEndInAnAnswerOrARefusal) {
  for (const double force : {1e-300, 1e-6, 1e3, 1e150}) {
    for (const double velocity : {1e-12, 10.0, -10.0}) {
      for (const double position : {3.3e-7, 0.165}) {
        Scene scene = paper_scene();
        scene.duration = 0.002;
        scene.bow = {.position = position, .velocity = velocity, .normal_force = force};
        const Simulation run = run_with(scene);
        if (run.diverged_at) {
          EXPECT_FALSE(run.explanation.empty());
          EXPECT_TRUE(run.velocity.samples.empty());
        }
        for (const double v : run.velocity.samples) ASSERT_TRUE(std::isfinite(v));
        for (const double f : run.force.samples) ASSERT_LE(std::abs(f), 0.4 * force * (1 + 1e-12));
      }
    }
  }
}

// Speeds far below the rounding of the force's values leave nothing to resolve.
TEST(ModalEvent, ABowOfDenormalSpeedHasNoTailToRefine) {
  Scene scene = paper_scene();
  scene.bow.velocity = 1e-310;
  for (const double step : {1e-7, 1e-6, 1e-4}) {
    scene.duration = 1000.0 * step;
    const Simulation run = run_with(scene, {}, 1.0 / step);
    EXPECT_FALSE(run.diverged_at) << step << ": " << run.explanation;
    const Simulation free = run_with(scene, {.tail_ratio = 1e3}, 1.0 / step);
    EXPECT_EQ(run.refined_steps, free.refined_steps) << step;
  }
}

TEST(ModalEvent, RefusesOptionsOutOfRange) {
  EXPECT_THROW(ModalEvent({.nodes = 6}), InvalidInput);
  EXPECT_THROW(ModalEvent({.slope_number = 2.0}), InvalidInput);
  EXPECT_THROW(ModalEvent({.attach = "litteral"}), InvalidInput);
  EXPECT_THROW(ModalEvent({.tail_ratio = 0.0}), InvalidInput);
  EXPECT_THROW(run_with(paper_scene(), {.max_step = -1.0}), InvalidInput);
}

}  // namespace
}  // namespace modcal::modal_event_test
