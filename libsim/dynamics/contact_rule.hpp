// Stick–slip rule of one contact point on a fixed time grid, as plain values for the step loop.
//
// Sliding with sign side = sgn(v_c): f = −side·g(|v_c|). The string attaches at the first step at
// which v_c has changed sign (y_c = 0 there: the paper's literal rule) and is released at the first
// step at which |−K_a y_c − C_a v_c| exceeds μ_S F_N (Debut, Delaune and Antunes, 2010, eqs. 5–8).
#pragma once

#include <cmath>
#include <cstdint>

#include "libsim/dynamics/step_loop.hpp"

namespace modcal {

template <typename Law>
class ContactRule {
 public:
  ContactRule(const ContactParameters& parameters, const Law& law, double time_step,
              double initial_displacement, double initial_velocity)
      : p_(parameters), law_(law), time_step_(time_step) {
    const double slip = initial_velocity - p_.bow_velocity;
    sticking_ = slip == 0.0;
    side_ = slip < 0.0 ? -1.0 : 1.0;
    attach_displacement_ = initial_displacement;
    speed_ = std::abs(slip);
  }

  std::uint64_t attachments() const { return attachments_; }
  std::uint64_t releases() const { return releases_; }

  /// Force at t = 0.
  double initial_force() const { return sticking_ ? 0.0 : -side_ * law_.at(speed_).force; }

  /// Force for the known velocity v and displacement y of step k.
  double explicit_force(double v, double y, std::uint64_t k) {
    const double slip = v - p_.bow_velocity;
    if (sticking_) {
      const double force = -p_.stiffness * elongation(y, k) - p_.damping * slip;
      if (std::abs(force) <= p_.static_limit) return force;
      release(slip != 0.0 ? slip : -force);
    } else if (slip * side_ <= 0.0) {
      const double force = -p_.damping * slip;
      if (std::abs(force) <= p_.static_limit) {
        attach(y, k);
        return force;
      }
      side_ = -side_;  // too fast to be caught: it slides on in the other direction
    }
    return -side_ * law_.at(std::abs(slip)).force;
  }

  /// Force that solves f = F(v), v = free_v + b f and y = free_y + b_y f at the end of step k.
  double implicit_force(double free_v, double b, double free_y, double b_y, std::uint64_t k) {
    const double slip = free_v - p_.bow_velocity;
    if (sticking_) {
      const double force = -(p_.stiffness * elongation(free_y, k) + p_.damping * slip) /
                           (1.0 + p_.stiffness * b_y + p_.damping * b);
      if (std::abs(force) <= p_.static_limit) return force;
      release(-force);
      speed_ = 0.0;
    } else if (side_ * slip < b * law_.at(0.0).force) {
      const double force = -p_.damping * slip / (1.0 + p_.damping * b);
      if (std::abs(force) <= p_.static_limit) {
        attach(free_y + b_y * force, k);
        return force;
      }
      side_ = -side_;
    }
    return -side_ * sliding_force(side_ * slip, b);
  }

 private:
  double elongation(double y, std::uint64_t k) const {
    const double elapsed = time_step_ * static_cast<double>(k - attach_step_);
    return y - attach_displacement_ - p_.bow_velocity * elapsed;
  }
  void attach(double y, std::uint64_t k) {
    sticking_ = true;
    attach_displacement_ = y;
    attach_step_ = k;
    ++attachments_;
  }
  void release(double direction) {
    sticking_ = false;
    side_ = direction < 0.0 ? -1.0 : 1.0;
    ++releases_;
  }
  // Root u ≥ 0 of u + b g(u) = w: Newton on a convex function that rises because b·|g'| < 1 (the
  // simulator refuses larger steps), so after one iteration it decreases monotonically to the root.
  // Without a root at u ≥ 0 (the release would start in the wrong direction) the force stays at the
  // limit for this step.
  double sliding_force(double w, double b) {
    const auto at_rest = law_.at(0.0);
    if (!(w > b * at_rest.force)) {
      speed_ = 0.0;
      return at_rest.force;
    }
    double u = speed_;
    auto point = law_.at(u);
    for (int iteration = 0; iteration < 50; ++iteration) {
      double next = u - (u + b * point.force - w) / (1.0 + b * point.slope);
      if (next < 0.0) next = 0.0;
      const double change = std::abs(next - u);
      u = next;
      point = law_.at(u);
      if (change <= 1e-9 * u) break;  // quadratic convergence: the next change is below rounding
    }
    speed_ = u;
    return point.force;
  }

  ContactParameters p_;
  Law law_;
  double time_step_;
  bool sticking_ = false;
  double side_ = -1.0;
  double attach_displacement_ = 0.0;
  std::uint64_t attach_step_ = 0;
  double speed_ = 0.0;
  std::uint64_t attachments_ = 0;
  std::uint64_t releases_ = 0;
};

}  // namespace modcal
