// What the fixed-step schemes must reproduce: closed forms, an extended-precision twin, themselves
// from half-way on, each other.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <vector>

#include "libsim/dynamics/fixed_step/fixed_step.hpp"
#include "libsim/dynamics/fixed_step/step_loop.hpp"
#include "libsim/dynamics/scene/contact_modes.hpp"
#include "tests/libsim/dynamics/block_on_belt.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::fixed_step_oracles_test {
namespace {

// Half critical: the next sticking forgets what a release amplifies.
constexpr double kDamping = 2.0;

constexpr ForceTiming kTimings[] = {ForceTiming::kPreviousStep, ForceTiming::kImplicit};

WeightsOfPole weights_of(ForceTiming timing) {
  return timing == ForceTiming::kImplicit ? first_order_hold_weights : trapezoidal_weights;
}

// One undamped mode under a belt of 0.05 m/s.
struct OneMode {
  ModalBasis basis;
  ContactModes modes;
};
OneMode one_mode() {
  Scene scene = paper_scene();
  scene.string.modes = 1;
  OneMode mode{.basis = make_modal_basis(scene.string)};
  mode.basis.zeta[0] = 0.0;
  mode.modes = contact_modes(mode.basis, 0.165, {});
  return mode;
}

struct Motion {
  std::vector<double> displacement, velocity, force;
  LoopCounts counts;
};

// `steps` steps from y and v, every `stride`-th a sample; the explicit scheme knows the force
// before the first.
Motion run(ContactModes modes, ForceTiming timing, double h, std::size_t samples,
           std::size_t stride, double y = 0.0, double v = 0.0, double force_before = 0.0) {
  const SchemeWeights weights = scheme_weights(modes, h, weights_of(timing));
  Motion motion{
      std::vector<double>(samples), std::vector<double>(samples), std::vector<double>(samples), {}};
  const FixedStepRun plan{.timing = timing,
                          .time_step = h,
                          .steps_per_sample = stride,
                          .samples = samples,
                          .targets = {.displacement = motion.displacement.data(),
                                      .velocity = motion.velocity.data(),
                                      .force = motion.force.data()},
                          .point_targets = {},
                          .switches = {},
                          .stop = {}};
  const SteadyContact contact{.parameters = {.bow_velocity = 0.05,
                                             .static_limit = 0.4,
                                             .stiffness = 1e4,
                                             .damping = kDamping},
                              .law = ExponentialSliding{.dynamic_force = 0.3},
                              .initial_displacement = y,
                              .initial_velocity = v};
  // Z = v + i ω y (ζ = 0, φ = 1), and what the force before leaves of it: r Z' = r Z + d₀ f.
  modes.initial[0] = std::complex<double>(v, modes.pole[0].imag() * y) +
                     weights[0].older / weights[0].propagate * modes.drive[0] * force_before;
  const double side = v < 0.05 ? 1.0 : -1.0;
  StepCoefficients coefficients =
      make_step_coefficients(modes, weights, timing == ForceTiming::kImplicit ? side * 0.3 : 0.0);
  motion.counts = run_step_loop(plan, contact, coefficients);
  return motion;
}

// Both schemes know switches only to the step: first order. Over a factor of 64 the luck of where
// the grid puts them leaves an order above 0.75.
TEST(FixedSteps, OneModeConvergesToTheBlockOnABelt) {
  const OneMode mode = one_mode();
  const std::size_t samples = 512;
  const double interval = 1.0 / 5120.0;
  for (const ForceTiming timing : kTimings) {
    const auto error_with = [&](std::size_t stride) {
      const Motion motion =
          run(mode.modes, timing, interval / static_cast<double>(stride), samples, stride);
      BlockOnBelt block(mode.basis.mass[0], mode.basis.omega[0], 0.4, 0.3, 1e4, kDamping, 0.05,
                        0.0);
      double error = 0.0;
      for (std::size_t k = 1; k < samples; ++k) {
        const auto point = block.at(static_cast<double>(k) * interval);
        error += std::pow(point.y - motion.displacement[k], 2);
      }
      EXPECT_GE(block.switches(), 4);
      // The last switch may fall on the other side of the record's end.
      EXPECT_NEAR(static_cast<double>(motion.counts.attachments + motion.counts.releases),
                  block.switches(), 1.0);
      return std::sqrt(error / static_cast<double>(samples));
    };
    const double coarse = error_with(64), fine = error_with(4096);
    EXPECT_LT(fine, 1e-6);  // of an amplitude of 0.2 mm
    EXPECT_GT(std::log2(coarse / fine) / 6.0, 0.75);
  }
}

// step(a + b) = step(b) after step(a). One mode shows its whole state, y and v, and the contact has
// no memory while it slides; the explicit scheme remembers one force.
TEST(FixedSteps, GoOnFromWhereTheyStopped) {
  const OneMode mode = one_mode();
  const double h = 2e-6;
  const std::size_t samples = 30000;
  for (const ForceTiming timing : kTimings) {
    const Motion whole = run(mode.modes, timing, h, samples, 1);
    EXPECT_GE(whole.counts.releases, 2u);
    std::size_t tried = 0;
    for (std::size_t cut = 500; cut < samples; cut += 1000) {
      if (std::abs(std::abs(whole.force[cut]) - 0.3) > 1e-12) continue;  // it sticks
      const double remembered = timing == ForceTiming::kImplicit ? 0.0 : whole.force[cut - 1];
      const Motion rest = run(mode.modes, timing, h, samples - cut, 1, whole.displacement[cut],
                              whole.velocity[cut], remembered);
      double error = 0.0;
      for (std::size_t k = 1; k < rest.velocity.size(); ++k) {
        error = std::max(error, std::abs(rest.velocity[k] - whole.velocity[cut + k]));
      }
      // Rounding of 30 000 steps, 1e-16 of 0.25 m/s each, which a release carries over from y to v
      // 40 times as large (see the block on a belt of the event-driven integrator), twice allowed
      // for.
      EXPECT_LT(error, 30000 * 1e-16 * 40 * 40 * 0.25) << cut;
      ++tried;
    }
    EXPECT_GE(tried, 3u);
  }
}

// The same steps in extended precision, written out from the one-step weights: no lookahead, no
// coordinates but Z, the friction equation by Newton's iteration.
class Twin {
 public:
  using Real = long double;
  using Complex = std::complex<Real>;

  Twin(const Scene& scene, ForceTiming timing, Real h)
      : timing_(timing), h_(h), bow_(scene.bow.velocity) {
    const ContactModes modes = scene_modes(scene);
    for (std::size_t n = 0; n < modes.size(); ++n) {
      const Complex pole(modes.pole[n].real(), modes.pole[n].imag());
      const Complex x = pole * h;
      Complex r, older, newer;
      if (timing == ForceTiming::kImplicit) {
        Complex term = 0.5L, second = term;
        for (int j = 1; j <= 25; ++j) {
          term *= x / static_cast<Real>(j + 2);
          second += term;
        }
        const Complex first = Real(1) + x * second;
        r = Real(1) + x * first;
        older = h * (first - second);
        newer = h * second;
      } else {
        r = (Real(1) + x / Real(2)) / (Real(1) - x / Real(2));
        older = newer = h / Real(2) / (Real(1) - x / Real(2));
      }
      propagate_.push_back(r);
      older_.push_back(older * Real(modes.drive[n]));
      newer_.push_back(newer * Real(modes.drive[n]));
      damped_.push_back(pole.imag());
      quadrature_.push_back(-pole.real() / pole.imag());
      mobility_ += modes.drive[n];
    }
    state_.resize(modes.size());
    damping_ = 2.0L * std::sqrt(1e5L / mobility_);
    force_ = sliding(0.1L);
    velocity_response_ = velocity(newer_);
    displacement_response_ = displacement(newer_);
  }

  void step() {
    time_ += h_;
    const bool implicit = timing_ == ForceTiming::kImplicit;
    const Real old_force = implicit ? force_ : before_;
    const Real new_force = implicit ? Real(0) : force_;
    for (std::size_t n = 0; n < state_.size(); ++n) {
      state_[n] = propagate_[n] * state_[n] + older_[n] * old_force + newer_[n] * new_force;
    }
    before_ = force_;
    if (implicit) {
      force_ = solved();
      for (std::size_t n = 0; n < state_.size(); ++n) state_[n] += newer_[n] * force_;
    } else {
      force_ = known(velocity(state_), displacement(state_));
    }
  }
  Real velocity() const { return velocity(state_); }
  Real force() const { return force_; }
  int switches() const { return switches_; }

 private:
  using State = std::vector<Complex>;
  Real velocity(const State& z) const {
    Real sum = 0;
    for (std::size_t n = 0; n < z.size(); ++n) sum += z[n].real() - quadrature_[n] * z[n].imag();
    return sum;
  }
  Real displacement(const State& z) const {
    Real sum = 0;
    for (std::size_t n = 0; n < z.size(); ++n) sum += z[n].imag() / damped_[n];
    return sum;
  }
  // The string slides backwards throughout the records that are compared.
  static Real sliding(Real speed) { return 0.2L + 0.2L * std::exp(-5.0L * speed); }
  Real held(Real v, Real y) const {
    return -1e5L * (y - anchor_ - bow_ * (time_ - attached_)) - damping_ * (v - bow_);
  }
  void attach(Real y) {
    sticking_ = true;
    anchor_ = y;
    attached_ = time_;
    ++switches_;
  }
  void release() {
    sticking_ = false;
    ++switches_;
  }
  Real known(Real v, Real y) {
    if (sticking_) {
      if (std::abs(held(v, y)) <= 0.4L) return held(v, y);
      release();
    } else if (v >= bow_) {
      attach(y);
      return held(v, y);
    }
    return sliding(bow_ - v);
  }
  Real solved() {
    const Real v = velocity(state_), y = displacement(state_);
    const Real b = velocity_response_, by = displacement_response_;
    if (sticking_) {
      const Real force = held(v, y) / (1 + 1e5L * by + damping_ * b);
      if (std::abs(force) <= 0.4L) return force;
      release();
    } else if (bow_ - v < b * 0.4L) {
      const Real force = -damping_ * (v - bow_) / (1 + damping_ * b);
      attach(y + by * force);
      return force;
    }
    if (!(bow_ - v > b * 0.4L)) return 0.4L;
    Real speed = bow_ - v;
    for (int k = 0; k < 50; ++k) {
      const Real g = sliding(speed);
      speed -= (speed + b * g - (bow_ - v)) / (1 - b * 5.0L * (g - 0.2L));
    }
    return sliding(speed);
  }

  ForceTiming timing_;
  Real h_, bow_, time_ = 0, mobility_ = 0, damping_ = 0;
  State propagate_, older_, newer_, state_;
  std::vector<Real> damped_, quadrature_;
  Real velocity_response_ = 0, displacement_response_ = 0;
  Real force_ = 0, before_ = 0, anchor_ = 0, attached_ = 0;
  bool sticking_ = false;
  int switches_ = 0;
};

TEST(FixedSteps, TakeTheStepsOfTheirExtendedPrecisionTwins) {
  Scene scene = paper_scene();
  scene.duration = 0.006;
  const double h = 1e-6;
  for (const ForceTiming timing : kTimings) {
    const OutputRequest outputs = OutputRequest::all();
    const Simulation run =
        timing == ForceTiming::kImplicit
            ? ModalExact({.time_step = h}).simulate(scene, 50000.0, outputs)
            : NewmarkExplicit({.time_step = h}).simulate(scene, 50000.0, outputs);
    Twin twin(scene, timing, h);
    double error = 0.0;
    for (std::size_t k = 1; k < run.velocity.size(); ++k) {
      for (int inner = 0; inner < 20; ++inner) twin.step();
      error =
          std::max(error, std::abs(static_cast<double>(twin.velocity()) - run.velocity.samples[k]));
    }
    EXPECT_GE(twin.switches(), 4);
    EXPECT_EQ(run.attachments + run.releases, static_cast<std::size_t>(twin.switches()));
    // Rounding of 6000 steps, 1e-16 of 1 m/s each, grows by the contact's transient sensitivity,
    // below 1e3 in 6 ms.
    EXPECT_LT(error, 6000 * 1e-16 * 1e3);
  }
}

// Two schemes, one motion: their distance is of first order, that of the switches.
TEST(FixedSteps, ConvergeToOneAnswer) {
  Scene scene = paper_scene();
  scene.duration = 0.005;
  const auto distance = [&](double h) {
    const Simulation a =
        NewmarkExplicit({.time_step = h}).simulate(scene, 50000.0, OutputRequest::all());
    const Simulation b =
        ModalExact({.time_step = h}).simulate(scene, 50000.0, OutputRequest::all());
    double error = 0.0, power = 0.0;
    for (std::size_t k = 0; k < a.displacement.size(); ++k) {
      error += std::pow(a.displacement.samples[k] - b.displacement.samples[k], 2);
      power += std::pow(b.displacement.samples[k], 2);
    }
    return std::sqrt(error / power);
  };
  const double coarse = distance(2e-6), fine = distance(6.25e-8);
  EXPECT_LT(fine, 2e-3);
  EXPECT_GT(std::log2(coarse / fine) / 5.0, 0.8);
}

}  // namespace
}  // namespace modcal::fixed_step_oracles_test
