// An independent integration of the same contact in extended precision: classical Runge–Kutta on
// (q, q̇) with tiny steps and switches found by bisection of the step. Shares nothing with the
// simulators but the modal basis.
#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "libsim/model/modal_basis.hpp"

namespace modcal {

class LongDoubleTwin {
 public:
  using Real = long double;
  struct Bow {
    Real velocity, dynamic_force, force_drop, decay, stiffness, damping;
    /// Functions of time that multiply velocity and forces, and ∫ of the first; none: steady.
    std::function<Real(Real)> velocity_factor, load, travel_factor;

    Real velocity_at(Real t) const {
      return velocity_factor ? velocity * velocity_factor(t) : velocity;
    }
    Real travel(Real t) const { return travel_factor ? velocity * travel_factor(t) : velocity * t; }
    Real load_at(Real t) const { return load ? load(t) : 1.0L; }
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
  Real load() const { return bow_.load_at(time_); }
  int switches() const { return switches_; }

  /// One step of length h with any switches inside it, located to 1e-19 of the step.
  void step(Real h) {
    while (h > 0.0L) {
      std::vector<Real> next = advanced(h);
      if (!past_switch(next, time_ + h)) {
        state_ = std::move(next);
        time_ += h;
        // A bow that comes back meets the string as it moves then.
        if (bow_.load_at(time_) == 0.0L)
          side_ = velocity() < bow_.velocity_at(time_) ? -1.0L : 1.0L;
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
    const Real slip = sum(x, shape_.size()) - bow_.velocity_at(t);
    if (!sticking_) {
      const Real excess = bow_.force_drop * std::exp(-bow_.decay * side_ * slip);
      return -side_ * bow_.load_at(t) * (bow_.dynamic_force + excess);
    }
    const Real elongation = sum(x, 0) - y_attach_ - (bow_.travel(t) - bow_.travel(t_attach_));
    return -bow_.stiffness * elongation - bow_.damping * slip;
  }
  bool past_switch(const std::vector<Real>& x, Real t) const {
    if (bow_.load_at(t) == 0.0L) return sticking_;
    if (sticking_) {
      return std::abs(force(x, t)) > bow_.load_at(t) * (bow_.dynamic_force + bow_.force_drop);
    }
    return side_ * (sum(x, shape_.size()) - bow_.velocity_at(t)) < 0.0L;
  }
  void switch_over() {
    ++switches_;
    sticking_ = !sticking_;
    if (sticking_) {
      y_attach_ = displacement();
      t_attach_ = time_;
    } else {
      side_ = velocity() < bow_.velocity_at(time_) ? -1.0L : 1.0L;
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
