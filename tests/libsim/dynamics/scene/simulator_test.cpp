#include "libsim/dynamics/scene/simulator.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "libsim/base/error.hpp"
#include "libsim/dynamics/fixed_step/fixed_step.hpp"
#include "libsim/dynamics/friction/friction_law.hpp"
#include "libsim/dynamics/gestures/gesture.hpp"
#include "libsim/model/damping.hpp"
#include "libsim/signal/statistics.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::simulator_test {
namespace {

ModalExact exact_with(double step) { return ModalExact({.time_step = step}); }

void set_damping(Scene& scene, double ratio) {
  scene.string.damping =
      Choice<DampingLaw>::of<ConstantDamping>("constant", ConstantDamping::Options{ratio});
}

void set_friction(Scene& scene, CoulombExponential::Options options) {
  scene.friction = Choice<FrictionLaw>::of<CoulombExponential>("coulomb_exponential", options);
}

double relative_difference(const Signal& a, const Signal& b) {
  double error = 0.0, power = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    error += (a.samples[i] - b.samples[i]) * (a.samples[i] - b.samples[i]);
    power += b.samples[i] * b.samples[i];
  }
  return std::sqrt(error / power);
}

TEST(ModalExact, IsOfSecondOrderWhileTheStringSlides) {
  Scene scene = paper_scene();
  scene.string.modes = 10;  // all steps below resolve the top mode: ωΔt ≤ 0.25
  scene.bow.velocity = 1.5;
  scene.bow.normal_force = 0.3;
  scene.duration = 0.01;
  set_friction(scene, {.decay = 1.0});
  const auto run = [&scene](double step) {
    return exact_with(step).simulate(scene, 50000.0, OutputRequest::all());
  };
  const Simulation reference = run(1.25e-6 / 8);
  EXPECT_EQ(reference.attachments, 0u);  // smooth: no switch
  const double coarse = relative_difference(run(5e-6).velocity, reference.velocity);
  const double fine = relative_difference(run(2.5e-6).velocity, reference.velocity);
  EXPECT_LT(coarse, 1e-3);
  // log2 of the ratio is 2 up to the next term, O(Δt), and the reference's own 1/256.
  EXPECT_NEAR(std::log2(coarse / fine), 2.0, 0.1);
}

TEST(NewmarkExplicit, TakesTheSameStepsAsTheSchemeWrittenWithAccelerations) {
  Scene scene = paper_scene();
  scene.duration = 0.01;
  const double rate = 50000.0, dt = 1e-6;
  const Simulation run =
      NewmarkExplicit({.time_step = dt}).simulate(scene, rate, OutputRequest::all());
  ASSERT_EQ(run.time_step, dt);

  const ModalBasis basis = make_modal_basis(scene.string);
  const auto shape = basis.shape_at(scene.bow.position);
  std::vector<double> q(50), v(50), a(50);
  double inverse_mass = 0.0;
  for (std::size_t n = 0; n < 50; ++n) inverse_mass += shape[n] * shape[n] / basis.mass[n];
  const double ca = 2.0 * std::sqrt(1e5 / inverse_mass);
  bool sticking = false;
  double side = -1.0, y_attach = 0.0, t_attach = 0.0;
  double force = 0.2 + 0.2 * std::exp(-5.0 * 0.1);
  double worst = 0.0;
  for (int step = 1; step <= 9980; ++step) {
    double yc = 0.0, vc = 0.0;
    for (std::size_t n = 0; n < 50; ++n) {
      const double w = basis.omega[n], z = basis.zeta[n];
      const double qp = q[n] + dt * v[n] + dt * dt / 4 * a[n];
      const double vp = v[n] + dt / 2 * a[n];
      a[n] = (shape[n] * force / basis.mass[n] - 2 * z * w * vp - w * w * qp) /
             (1 + z * w * dt + w * w * dt * dt / 4);
      q[n] = qp + dt * dt / 4 * a[n];
      v[n] = vp + dt / 2 * a[n];
      yc += shape[n] * q[n];
      vc += shape[n] * v[n];
    }
    const double slip = vc - 0.1;
    if (!sticking && slip * side <= 0) {
      sticking = true;
      y_attach = yc;
      t_attach = step * dt;
    }
    if (sticking) {
      force = -1e5 * (yc - y_attach - 0.1 * (step * dt - t_attach)) - ca * slip;
      if (std::abs(force) > 0.4) {
        sticking = false;
        side = slip < 0 ? -1.0 : 1.0;
      }
    }
    if (!sticking) force = -side * (0.2 + 0.2 * std::exp(-5.0 * std::abs(slip)));
    if (step % 20 == 0) {
      worst =
          std::max(worst, std::abs(run.velocity.samples[static_cast<std::size_t>(step / 20)] - vc));
    }
  }
  // Rounding of 1e4 steps amplified by the contact's transient sensitivity, below 1e6 over 10 ms.
  EXPECT_LT(worst, 1e-9);
}

TEST(Simulators, EnergyNeverGrowsWithoutTheBow) {
  Scene scene = paper_scene();
  scene.string.modes = 50;
  scene.bow.normal_force = 0.0;
  scene.duration = 0.1;
  for (std::size_t n = 1; n <= 50; ++n) {  // plucked at L/5; the node modes of x_c stay at rest
    const bool node = n % 11 == 0;
    scene.initial.displacement.push_back(
        node ? 0.0 : 2e-3 * sine_shape(n, 0.2) / static_cast<double>(n * n));
    scene.initial.velocity.push_back(0.0);
  }
  for (const double ratio : {0.0, 1e-3}) {
    set_damping(scene, ratio);
    const ModalBasis basis = make_modal_basis(scene.string);
    for (const char* name : {"modal_exact", "newmark_explicit"}) {
      // Reaction and velocity are linear in the state: the state is read off by restarting.
      const auto simulator = Choice<Simulator>(name).make();
      const Simulation run = simulator->simulate(scene, 51200.0, OutputRequest::all());
      const auto power = [&run](std::size_t from) {
        double sum = 0.0;
        for (std::size_t k = from; k < from + 1024; ++k) {
          sum += run.velocity.samples[k] * run.velocity.samples[k];
        }
        return sum;
      };
      // Whole periods of 196 Hz do not fit 1024 samples, so a window's power wobbles by the share
      // of the partial period; windows 0.08 s apart lose exp(−2·1e-3·2π·196·0.08) = 18 % at least.
      if (ratio > 0.0) {
        EXPECT_LT(power(4096), power(0)) << name;
      } else {
        EXPECT_NEAR(power(4096) / power(0), 1.0, 0.2) << name;
      }
      for (const double f : run.force.samples) ASSERT_EQ(f, 0.0);
    }
  }
}

// Helmholtz motion: slip velocity at the contact −v_bow (1 − β)/β and slip share β, β = x_c/L
// (Cremer, 1984), for a string with rounded corners: 50 modes round the corner over about
// L/(50 c) · 2 = 0.1 ms of the 0.46 ms slip, which both figures see at the 10 % level.
TEST(Simulators, ThePapersCaseIsHelmholtzMotion) {
  const Scene scene = paper_scene();
  const double beta = scene.bow.position / scene.string.length;
  for (const char* name : {"modal_exact", "newmark_explicit"}) {
    const Simulation run =
        Choice<Simulator>(name).make()->simulate(scene, 51200.0, OutputRequest::all());
    ASSERT_FALSE(run.diverged_at);
    double slip_speed = 0.0;
    std::size_t slipping = 0, fast = 0, slips = 0;
    bool was_slipping = false;
    const std::size_t from = 40960;  // the last 0.2 s
    for (std::size_t k = from; k < run.velocity.size(); ++k) {
      const bool slips_now = run.velocity.samples[k] < -0.25;
      if (slips_now) ++slipping;
      if (run.velocity.samples[k] < -0.8) {
        slip_speed += run.velocity.samples[k];
        ++fast;
      }
      if (slips_now && !was_slipping) ++slips;
      was_slipping = slips_now;
    }
    const double seconds = static_cast<double>(run.velocity.size() - from) / 51200.0;
    EXPECT_NEAR(static_cast<double>(slips) / seconds, 196.0, 5.1) << name;  // one slip a period
    EXPECT_NEAR(slip_speed / static_cast<double>(fast), -0.1 * (1 - beta) / beta, 0.1) << name;
    EXPECT_NEAR(static_cast<double>(slipping) / static_cast<double>(run.velocity.size() - from),
                beta, 0.1 * beta + 0.005)
        << name;
    EXPECT_GT(quantile(run.displacement.samples, 0.0), -2.5e-4) << name;
    EXPECT_LT(quantile(run.displacement.samples, 1.0), 6e-4) << name;
  }
}

TEST(Simulators, ComputeWhatIsAskedForAndNothingElse) {
  Scene scene = paper_scene();
  scene.duration = 0.02;
  for (const char* name : {"modal_exact", "newmark_explicit"}) {
    const auto simulator = Choice<Simulator>(name).make();
    const Simulation all = simulator->simulate(scene, 51200.0, OutputRequest::all());
    const Simulation one = simulator->simulate(scene, 51200.0, {.right_reaction = true});
    EXPECT_EQ(one.right_reaction.samples, all.right_reaction.samples);
    EXPECT_TRUE(one.left_reaction.samples.empty());
    EXPECT_TRUE(one.force.samples.empty());
    EXPECT_TRUE(one.velocity.samples.empty());
    EXPECT_TRUE(one.displacement.samples.empty());
    EXPECT_EQ(all.modes_moved, 46u);  // x_c = L/11: modes 11, 22, 33, 44 have a node there
  }
}

TEST(PlanSteps, TakesTheNextSmallerStepThatDividesTheSamplingPeriod) {
  EXPECT_EQ(plan_steps(1e-6, 51200.0).steps_per_sample, 20u);  // 19.53 would fit
  EXPECT_EQ(plan_steps(1e-6, 51200.0).time_step, 1.0 / 51200.0 / 20.0);
  EXPECT_EQ(plan_steps(1e-6, 50000.0).steps_per_sample, 20u);
  EXPECT_EQ(plan_steps(1.0, 50000.0).steps_per_sample, 1u);
  EXPECT_THROW(plan_steps(0.0, 50000.0), InvalidInput);
  EXPECT_THROW(plan_steps(std::nan(""), 50000.0), InvalidInput);
}

TEST(Simulators, RefuseWhatTheyCannotDo) {
  const auto simulator = Choice<Simulator>("modal_exact").make();
  Scene outside = paper_scene();
  outside.bow.position = 0.34;
  EXPECT_THROW(simulator->simulate(outside, 51200.0, {}), InvalidInput);
  Scene empty = paper_scene();
  empty.duration = 0.0;
  EXPECT_THROW(simulator->simulate(empty, 51200.0, {}), InvalidInput);
  Scene steep = paper_scene();
  set_friction(steep, {.decay = 500.0});
  EXPECT_THROW(exact_with(1e-5).simulate(steep, 51200.0, {}), InvalidInput);
  Scene pulling = paper_scene();
  pulling.bow.force_gesture =
      Choice<Gesture>::of<RampGesture>("ramp", RampGesture::Options{.to = -1.0});
  EXPECT_THROW(simulator->simulate(pulling, 51200.0, {}), InvalidInput);
}

TEST(NewmarkExplicit, SaysSoWhenItDiverges) {
  Scene scene = paper_scene();
  scene.bow.normal_force = 0.0;
  scene.string.modes = 10;
  scene.initial.displacement.assign(10, 0.0);
  scene.initial.displacement[0] = 1e307;  // its velocity, ω times as much, overflows
  const Simulation run =
      NewmarkExplicit({.time_step = 1e-5}).simulate(scene, 51200.0, OutputRequest::all());
  EXPECT_TRUE(run.diverged_at.has_value());
  EXPECT_FALSE(run.explanation.empty());
  EXPECT_TRUE(run.force.samples.empty());
}

// One undamped mode held from the start by a spring of near-critical damping: h √(K_a/M) on either
// side of 3 − √5, the mode's own ωh = 0.006 adding a relative 1e-5.
TEST(NewmarkExplicit, RefusesStepsThatWouldCreateEnergy) {
  Scene scene = paper_scene();
  scene.string.modes = 1;
  scene.bow.position = 0.165;
  const double mass = make_modal_basis(scene.string).mass[0];
  const double rate = 200000.0, number = (3.0 - std::sqrt(5.0)) * rate;
  const NewmarkExplicit scheme({.time_step = 1.0 / rate});
  CoulombExponential::Options options;
  options.adherence.stiffness = 0.999 * number * number * mass;
  set_friction(scene, options);
  EXPECT_NO_THROW(scheme.simulate(scene, rate, {}));
  options.adherence.stiffness = 1.001 * number * number * mass;
  set_friction(scene, options);
  EXPECT_THROW(scheme.simulate(scene, rate, {}), InvalidInput);
  options = {.decay = 1e3};
  set_friction(scene, options);
  EXPECT_THROW(scheme.simulate(scene, rate, {}), InvalidInput);
  scene.bow.normal_force = 0.0;  // no contact, no limit
  EXPECT_NO_THROW(scheme.simulate(scene, rate, {}));
}

TEST(Simulators, RefuseInputsWhoseEnergyOverflows) {
  Scene scene = paper_scene();
  scene.bow.velocity = 1e200;
  for (const char* name : {"modal_event", "modal_exact", "newmark_explicit"}) {
    EXPECT_THROW(Choice<Simulator>(name).make()->simulate(scene, 51200.0, {}), InvalidInput);
  }
}

}  // namespace
}  // namespace modcal::simulator_test
