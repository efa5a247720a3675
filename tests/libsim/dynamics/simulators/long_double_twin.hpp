// An independent integration of the same contact in extended precision: classical Runge–Kutta on
// (q, q̇) with tiny steps and switches found by bisection of the step. Shares nothing with the
// simulators but the modal basis.
#pragma once

#include <cmath>
#include <vector>

#include "libsim/model/modal_basis.hpp"

namespace modcal {

class LongDoubleTwin {
 public:
  using Real = long double;
  struct Bow {
    Real velocity, dynamic_force, force_drop, decay, stiffness, damping;
  };

  LongDoubleTwin(const ModalBasis& basis, double contact, const Bow& bow) : bow_(bow) {
    const auto shape = basis.shape_at(contact);
    for (std::size_t n = 0; n < basis.size(); ++n) {
      square_.push_back(static_cast<Real>(basis.omega[n]) * basis.omega[n]);
      friction_.push_back(2.0L * basis.zeta[n] * basis.omega[n]);
      shape_.push_back(shape[n]);
      mass_.push_back(basis.mass[n]);
    }
    state_.resize(2 * basis.size());
  }

  Real displacement() const { return sum(state_, 0); }
  Real velocity() const { return sum(state_, shape_.size()); }
  Real force() const { return force(state_, time_); }
  int switches() const { return switches_; }

  /// One step of length h with any switches inside it, located to 1e-19 of the step.
  void step(Real h) {
    while (h > 0.0L) {
      std::vector<Real> next = advanced(h);
      if (!past_switch(next, time_ + h)) {
        state_ = std::move(next);
        time_ += h;
        return;
      }
      Real low = 0.0L, high = h;
      for (int k = 0; k < 70; ++k) {
        const Real middle = 0.5L * (low + high);
        (past_switch(advanced(middle), time_ + middle) ? high : low) = middle;
      }
      state_ = advanced(high);
      time_ += high;
      h -= high;
      switch_over();
    }
  }

 private:
  Real sum(const std::vector<Real>& x, std::size_t from) const {
    Real total = 0.0L;
    for (std::size_t n = 0; n < shape_.size(); ++n) total += shape_[n] * x[from + n];
    return total;
  }
  Real force(const std::vector<Real>& x, Real t) const {
    const Real slip = sum(x, shape_.size()) - bow_.velocity;
    if (!sticking_) {
      return -side_ * (bow_.dynamic_force + bow_.force_drop * std::exp(-bow_.decay * side_ * slip));
    }
    const Real elongation = sum(x, 0) - y_attach_ - bow_.velocity * (t - t_attach_);
    return -bow_.stiffness * elongation - bow_.damping * slip;
  }
  bool past_switch(const std::vector<Real>& x, Real t) const {
    if (sticking_) return std::abs(force(x, t)) > bow_.dynamic_force + bow_.force_drop;
    return side_ * (sum(x, shape_.size()) - bow_.velocity) < 0.0L;
  }
  void switch_over() {
    ++switches_;
    sticking_ = !sticking_;
    if (sticking_) {
      y_attach_ = displacement();
      t_attach_ = time_;
    } else {
      side_ = velocity() < bow_.velocity ? -1.0L : 1.0L;
    }
  }
  std::vector<Real> rate(const std::vector<Real>& x, Real t) const {
    const std::size_t n = shape_.size();
    const Real f = force(x, t);
    std::vector<Real> r(2 * n);
    for (std::size_t i = 0; i < n; ++i) {
      r[i] = x[n + i];
      r[n + i] = shape_[i] * f / mass_[i] - friction_[i] * x[n + i] - square_[i] * x[i];
    }
    return r;
  }
  std::vector<Real> advanced(Real h) const {
    const auto shifted = [this](const std::vector<Real>& r, Real by) {
      std::vector<Real> x = state_;
      for (std::size_t i = 0; i < x.size(); ++i) x[i] += by * r[i];
      return x;
    };
    const auto k1 = rate(state_, time_);
    const auto k2 = rate(shifted(k1, h / 2), time_ + h / 2);
    const auto k3 = rate(shifted(k2, h / 2), time_ + h / 2);
    const auto k4 = rate(shifted(k3, h), time_ + h);
    std::vector<Real> x = state_;
    for (std::size_t i = 0; i < x.size(); ++i) {
      x[i] += h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]);
    }
    return x;
  }

  Bow bow_;
  std::vector<Real> square_, friction_, shape_, mass_, state_;
  Real time_ = 0.0L, side_ = -1.0L, y_attach_ = 0.0L, t_attach_ = 0.0L;
  bool sticking_ = false;
  int switches_ = 0;
};

}  // namespace modcal
