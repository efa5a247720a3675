// Stick–slip of one mode against its closed form.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <vector>

#include "libsim/dynamics/event/event_loop.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::event {
namespace {

// One undamped mode, friction F_S at rest and F_D sliding: a block on a belt. Sliding backwards,
// y'' + ω²y = F_D/m; held, y'' + (C/m) y' + (ω² + K/m) y = (K (y_a + v_b τ) + C v_b)/m. Both
// solutions are elementary; their switches are roots of elementary functions, found here by
// bisection.
class BlockOnBelt {
 public:
  BlockOnBelt(double mass, double omega, double held, double sliding, double stiffness,
              double damping, double belt, double stretched)
      : m_(mass),
        w2_(omega * omega),
        static_(held),
        f_(sliding),
        k_(stiffness),
        c_(damping),
        vb_(belt),
        stretched_(stretched) {
    start(0.0, 0.0);
  }
  struct Point {
    double y, v;
  };
  Point at(double t) {
    while (t > switch_time_) {
      const Point p = solution(switch_time_ - start_time_);
      sticking_ = !sticking_;
      start_time_ = switch_time_;
      start(p.y, p.v);
    }
    return solution(t - start_time_);
  }
  int switches() const { return switches_; }

 private:
  using Complex = std::complex<double>;

  void start(double y, double v) {
    const double gamma = sticking_ ? c_ / (2 * m_) : 0.0;
    const double square = w2_ + (sticking_ ? k_ / m_ : 0.0);
    // Particular solution a + bτ.
    b_ = sticking_ ? k_ * vb_ / m_ / square : 0.0;
    a_ = (sticking_ ? (k_ * (y - stretched_) + c_ * vb_) / m_ - 2 * gamma * b_ : f_ / m_) / square;
    attach_ = y - stretched_;
    // y = a + bτ + Re(A e^{sτ}), s = −γ + iΩ.
    const double frequency = std::sqrt(square - gamma * gamma);
    s_ = {-gamma, frequency};
    const double q = y - a_, p = v - b_;
    amplitude_ = Complex(q, -(p + gamma * q) / frequency);
    switch_time_ = start_time_ + next_switch(0.02 / std::abs(s_));
    ++switches_;
  }
  Point solution(double tau) const {
    const Complex e = amplitude_ * std::exp(s_ * tau);
    return {a_ + b_ * tau + e.real(), b_ + (s_ * e).real()};
  }
  // Positive until the switch.
  double margin(double tau) const {
    const Point p = solution(tau);
    if (!sticking_) return vb_ - p.v;
    return static_ - std::abs(k_ * (p.y - attach_ - vb_ * tau) + c_ * (p.v - vb_));
  }
  double next_switch(double scan) const {
    double low = 0.0;
    while (!(margin(low) > 0.0)) low += 1e-3 * scan;  // leave the last switch's own zero
    double high = low + scan;
    while (margin(high) > 0.0) {
      if (high > 1.0) return HUGE_VAL;  // it slides on, a little slower than the belt, for good
      low = high;
      high += scan;
    }
    for (int k = 0; k < 100; ++k) {
      const double middle = 0.5 * (low + high);
      (margin(middle) > 0.0 ? low : high) = middle;
    }
    return high;
  }

  double m_, w2_, static_, f_, k_, c_, vb_, stretched_;
  bool sticking_ = false;
  double start_time_ = 0.0, switch_time_ = 0.0;
  double a_ = 0.0, b_ = 0.0, attach_ = 0.0;
  Complex s_, amplitude_;
  int switches_ = -1;
};

TEST(EventLoop, OneModeIsTheBlockOnABelt) {
  Scene scene = paper_scene();
  scene.string.modes = 1;
  ModalBasis basis = make_modal_basis(scene.string);
  basis.zeta[0] = 0.0;
  const ContactModes modes = contact_modes(basis, 0.165, {});
  for (const AttachRule rule : {AttachRule::kLiteral, AttachRule::kContinuous}) {
    for (const double damping : {0.0, 0.05}) {
      const std::size_t samples = 5121;
      std::vector<double> y(samples), v(samples);
      EventState state = initial_state(modes, 0.05);
      const EventCounts counts = run_event_loop(
          {.contact =
               {.bow_velocity = 0.05, .static_limit = 0.4, .stiffness = 1e4, .damping = damping},
           .law = ExponentialSliding{.dynamic_force = 0.3},
           .attach = rule,
           .grid_step = 1.0 / 51200.0,
           .samples = samples,
           .targets = {.displacement = y.data(), .velocity = v.data()}},
          modes, state);
      ASSERT_FALSE(counts.failure) << *counts.failure;
      const double stretched = rule == AttachRule::kContinuous ? -0.3 / 1e4 : 0.0;
      BlockOnBelt block(basis.mass[0], basis.omega[0], 0.4, 0.3, 1e4, damping, 0.05, stretched);
      double error = 0.0, error_y = 0.0;
      for (std::size_t k = 0; k < samples; ++k) {
        const auto point = block.at(static_cast<double>(k) / 51200.0);
        error = std::max(error, std::abs(point.v - v[k]));
        error_y = std::max(error_y, std::abs(point.y - y[k]));
      }
      EXPECT_GE(block.switches(), 4);
      EXPECT_EQ(counts.attachments + counts.releases, static_cast<std::size_t>(block.switches()));
      // Both are exact between switches, 1e-16 a step. A release carries an error of y over as
      // one of v: (F_S − F_D)/m · K/f' · δy with f' ≥ mω²v_b of the slow drag, 40 times ω δy; the
      // next sticking forgets most of it. Two such factors are allowed on 5000 steps of rounding.
      EXPECT_LT(error, 40 * 40 * 5000 * 1e-16 * 0.1);
      EXPECT_LT(error_y, 40 * 40 * 5000 * 1e-16 * 0.1 / basis.omega[0]);
    }
  }
}

}  // namespace
}  // namespace modcal::event
