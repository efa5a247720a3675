// Stick–slip rule of one contact point on a fixed time grid, as plain values for the step loop.
//
// Sliding with sign side = sgn(v_c): f = −side·g(|v_c|). The string attaches at the first step at
// which v_c has changed sign (y_c = 0 there: the paper's literal rule) and is released at the first
// step at which |−K_a y_c − C_a v_c| exceeds μ_S F_N (Debut, Delaune and Antunes, 2010, eqs. 5–8).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "libsim/dynamics/step_loop.hpp"

namespace modcal {

template <typename Law>
class ContactRule {
 public:
  ContactRule(const ContactParameters& parameters, const Law& law, double time_step,
              double initial_displacement, double initial_velocity)
      : p_(parameters), law_(law), time_step_(time_step), rest_force_(law.at(0.0).force) {
    const double slip = initial_velocity - p_.bow_velocity;
    sticking_ = slip == 0.0;
    side_ = slip < 0.0 ? -1.0 : 1.0;
    attach_displacement_ = initial_displacement;
    restart(std::abs(slip));
  }

  /// Response b of v and b_y of y to the force at the end of a step, for implicit_force().
  void set_response(double b, double b_y) {
    b_ = b;
    b_y_ = b_y;
    held_ = 1.0 / (1.0 + p_.stiffness * b_y + p_.damping * b);
    caught_ = 1.0 / (1.0 + p_.damping * b);
  }

  std::uint64_t attachments() const { return attachments_; }
  std::uint64_t releases() const { return releases_; }

  /// Force at t = 0.
  double initial_force() const { return sticking_ ? 0.0 : -side_ * law_.at(speed_[0]).force; }

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
  double implicit_force(double free_v, double free_y, std::uint64_t k) {
    const double slip = free_v - p_.bow_velocity;
    if (sticking_) {
      const double force = -(p_.stiffness * elongation(free_y, k) + p_.damping * slip) * held_;
      if (std::abs(force) <= p_.static_limit) return force;
      release(-force);
      restart(0.0);
    } else if (side_ * slip < b_ * rest_force_) {
      const double force = -p_.damping * slip * caught_;
      if (std::abs(force) <= p_.static_limit) {
        attach(free_y + b_y_ * force, k);
        return force;
      }
      side_ = -side_;
    }
    return -side_ * sliding_force(side_ * slip);
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
  // The law at a speed, and the speed.
  struct Tangent {
    double speed = 0.0;
    typename Law::Point point{};
  };
  Tangent tangent_at(double speed) const {
    const double u = speed > 0.0 ? speed : 0.0;
    return {u, law_.at(u)};
  }

  // Sliding begins, or goes on from an unsteady step, at this speed.
  void restart(double speed) {
    for (double& past : speed_) past = speed;
    for (Tangent& tangent : ahead_) tangent = tangent_at(speed);
  }

  // Root u ≥ 0 of u + b g(u) = w: Halley's iteration on a convex function that rises because
  // b·|g'| < 1 (the simulator refuses larger steps). It starts from the law at a speed extrapolated
  // two steps ahead (by the quintic through the last six): that exponential does not wait for the
  // running step. The last change δ is carried over to the force by the law's parabola; what that
  // leaves, |δ³ g'''|/6 ≤ 1e-15 · 0.23 g(0) for an exponential law, is rounding.
  // Without a root at u ≥ 0 (the release would start in the wrong direction) the force stays at the
  // limit for this step.
  // Not inlined: its many values would push the modes out of the step loop's registers.
  [[gnu::noinline]] double sliding_force(double w) {
    if (!(w > b_ * rest_force_)) {
      restart(0.0);
      return rest_force_;
    }
    Tangent at = ahead_[0];
    double force = rest_force_, u = at.speed;
    for (int iteration = 0; iteration < 50; ++iteration) {
      const double residual = at.speed + b_ * at.point.force - w;
      const double slope = 1.0 + b_ * at.point.slope;
      const double newton = residual / slope;
      const double wanted =
          at.speed - newton * (1.0 + 0.5 * newton * (b_ * at.point.curvature) / slope);
      u = wanted > 0.0 ? wanted : 0.0;
      const double change = u - at.speed;
      force = at.point.force + change * (at.point.slope + 0.5 * change * at.point.curvature);
      if (std::abs(change) <= 1e-5 * u) break;
      at = tangent_at(u);
    }
    for (int i = kPast - 1; i > 0; --i) speed_[i] = speed_[i - 1];
    speed_[0] = u;
    ahead_[0] = ahead_[1];
    ahead_[1] = tangent_at((21.0 * u - 70.0 * speed_[1]) + (105.0 * speed_[2] - 84.0 * speed_[3]) +
                           (35.0 * speed_[4] - 6.0 * speed_[5]));
    return force;
  }

  ContactParameters p_;
  Law law_;
  double time_step_;
  double rest_force_;  // g(0)
  double b_ = 0.0, b_y_ = 0.0, held_ = 1.0, caught_ = 1.0;
  bool sticking_ = false;
  double side_ = -1.0;
  double attach_displacement_ = 0.0;
  std::uint64_t attach_step_ = 0;
  static constexpr int kPast = 6;
  double speed_[kPast] = {};  // the last sliding speeds, newest first
  Tangent ahead_[2];          // for the next step and the one after
  std::uint64_t attachments_ = 0;
  std::uint64_t releases_ = 0;
};

}  // namespace modcal
