// Stick–slip of one mode in closed form.
#pragma once

#include <cmath>
#include <complex>

namespace modcal {

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

}  // namespace modcal
