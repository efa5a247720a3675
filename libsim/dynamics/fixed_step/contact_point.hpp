// One contact point of the general step loop: a moving bow, friction with or without a state.
//
// Every point answers the same calls. Within a step switch_state() and solve() may be called
// several times, with the motion that the other points' forces leave free; begin_step() and
// end_step() enclose them.
#pragma once

#include "libsim/dynamics/fixed_step/step_loop.hpp"

namespace modcal {

/// Spring and damper of one contact point.
struct PointAdherence {
  double stiffness = 0.0;  ///< K_a [N/m]
  double damping = 0.0;    ///< C_a [N s/m]
};

/// v = v_free + velocity·f, y = y_free + displacement·f of a point to its own force; both 0 where
/// the motion of the step is known before its force is (explicit scheme).
struct PointResponse {
  double velocity = 0.0, displacement = 0.0;
};

/// Stick–slip rule of ContactRule for a coefficient μ(u) [1] and a bow of any motion:
/// f = −side·F_N(t) μ(u) while sliding; attachment where v_c has changed sign, release where the
/// adherence force exceeds F_N(t) μ(0). A change of state within a step is not taken back in it.
template <typename Law>
class CoulombPoint {
 public:
  CoulombPoint(const Law& law, const PointAdherence& adherence, double y, double v,
               const BowInstant& bow)
      : law_(law), adherence_(adherence) {
    const double slip = v - bow.velocity;
    sticking_ = slip == 0.0;
    side_ = slip < 0.0 ? -1.0 : 1.0;
    anchor_ = y - bow.travel;
    speed_ = std::abs(slip);
  }

  double initial_force(const BowInstant& bow) const {
    return sticking_ ? 0.0 : -side_ * bow.normal_force * law_.at(speed_).force;
  }

  void begin_step() { changed_ = fresh_ = false; }

  /// Whether sticking begins or ends with this step, once at most; the point is then in its new
  /// state.
  bool switch_state(double free_v, double free_y, const PointResponse& b, const BowInstant& bow) {
    if (changed_) return false;
    const double slip = free_v - bow.velocity;
    const double limit = bow.normal_force * law_.at(0.0).force;
    if (sticking_) {
      const double force = held(slip, free_y, b, bow);
      if (std::abs(force) <= limit) return false;
      release(b.velocity == 0.0 && slip != 0.0 ? slip : -force);
      return true;
    }
    if (!(limit > 0.0 && side_ * slip <= b.velocity * limit)) return false;
    changed_ = true;
    if (std::abs(caught(slip, b)) <= limit) {
      sticking_ = fresh_ = true;
      ++attachments_;
    } else {
      side_ = -side_;  // too fast to be caught: it slides on in the other direction
    }
    return true;
  }

  /// The force in the present state.
  double solve(double free_v, double free_y, const PointResponse& b, const BowInstant& bow) {
    const double slip = free_v - bow.velocity;
    if (fresh_) {  // the spring is unstretched at the end of the step
      const double force = caught(slip, b);
      anchor_ = free_y + b.displacement * force - bow.travel;
      return force;
    }
    if (sticking_) return held(slip, free_y, b, bow);
    return -side_ * sliding_force(side_ * slip, b.velocity * bow.normal_force, bow.normal_force);
  }

  /// Whether friction can carry the force, but for what the solution for several points leaves.
  bool carries(double force, const BowInstant& bow) const {
    return std::abs(force) <= bow.normal_force * law_.at(0.0).force * (1.0 + 1e-7);
  }

  void end_step(double h, double velocity, double force, const BowInstant& bow) {
    if constexpr (requires { law_.advance(h, 0.0, 0.0); }) {
      const double speed = sticking_ ? 0.0 : std::abs(velocity - bow.velocity);
      law_.advance(h, speed, std::abs(force));
    }
  }

  std::uint64_t attachments() const { return attachments_; }
  std::uint64_t releases() const { return releases_; }
  const Law& law() const { return law_; }

 private:
  double held(double slip, double free_y, const PointResponse& b, const BowInstant& bow) const {
    const double stretch = free_y - anchor_ - bow.travel;
    return -(adherence_.stiffness * stretch + adherence_.damping * slip) /
           (1.0 + adherence_.stiffness * b.displacement + adherence_.damping * b.velocity);
  }
  double caught(double slip, const PointResponse& b) const {
    return -adherence_.damping * slip / (1.0 + adherence_.damping * b.velocity);
  }
  void release(double direction) {
    sticking_ = false;
    changed_ = true;
    side_ = direction < 0.0 ? -1.0 : 1.0;
    ++releases_;
    speed_ = 0.0;
  }
  // Newton's iteration on u + b μ(u) = w, a convex function that rises because b·|μ'| < 1, from the
  // last speed; F_N μ(u) at its root. Without a root at u ≥ 0 the force stays at the limit.
  double sliding_force(double w, double b, double normal_force) {
    auto at = law_.at(speed_);
    if (!(w > b * law_.at(0.0).force)) {
      speed_ = 0.0;
      return normal_force * law_.at(0.0).force;
    }
    for (int iteration = 0; iteration < 50; ++iteration) {
      const double wanted = speed_ - (speed_ + b * at.force - w) / (1.0 + b * at.slope);
      const double next = wanted > 0.0 ? wanted : 0.0;
      const double change = std::abs(next - speed_);
      speed_ = next;
      at = law_.at(speed_);
      if (change <= 1e-14 * speed_) break;
    }
    return normal_force * at.force;
  }

  Law law_;
  PointAdherence adherence_;
  bool sticking_ = false;
  bool changed_ = false;  // sticking began or ended in this step
  bool fresh_ = false;    // sticking began in this step
  double side_ = -1.0, anchor_ = 0.0, speed_ = 0.0;
  std::uint64_t attachments_ = 0, releases_ = 0;
};

/// Bristle friction: one smooth equation, no switches. Attachments and releases count the changes
/// of the sign of v_c.
class BristlePoint {
 public:
  BristlePoint(const BristleFriction& law, double time_step, double v, const BowInstant& bow)
      : law_(law), time_step_(time_step), slip_(v - bow.velocity) {}

  double initial_force(const BowInstant& /*bow*/) const { return 0.0; }
  void begin_step() {}
  bool switch_state(double /*free_v*/, double /*free_y*/, const PointResponse& /*b*/,
                    const BowInstant& /*bow*/) {
    return false;
  }

  /// Root s of s − s_free − b f(s): the force opposes the slip, so the root lies between s_free and
  /// where the force's change of the slip brings it; bisection guards the secant steps.
  double solve(double free_v, double /*free_y*/, const PointResponse& b, const BowInstant& bow) {
    const double free_slip = free_v - bow.velocity;
    const auto force_at = [&](double s) {
      return law_.step(time_step_, s, bow.normal_force).force;
    };
    const double first = force_at(free_slip);
    if (b.velocity == 0.0 || first == 0.0) return first;
    const auto residual = [&](double s) { return s - free_slip - b.velocity * force_at(s); };
    double near = free_slip, at_near = -b.velocity * first;
    double reach = -at_near, far = near + reach, at_far = residual(far);
    for (int i = 0; i < 60 && at_far * at_near > 0.0; ++i) {
      reach *= 2.0;
      far = free_slip + reach;
      at_far = residual(far);
    }
    return force_at(bracketed_root(residual, near, at_near, far, at_far));
  }

  bool carries(double /*force*/, const BowInstant& /*bow*/) const { return true; }

  void end_step(double h, double velocity, double /*force*/, const BowInstant& bow) {
    const double slip = velocity - bow.velocity;
    law_.deflection = law_.step(h, slip, bow.normal_force).deflection;
    const bool turned = slip * slip_ < 0.0;
    turns_ += turned ? 1 : 0;
    slip_ = slip;
  }

  std::uint64_t attachments() const { return turns_; }
  std::uint64_t releases() const { return turns_; }
  const BristleFriction& law() const { return law_; }

 private:
  // Illinois variant of the false position; both ends enclose a change of sign.
  template <typename Function>
  static double bracketed_root(const Function& f, double a, double fa, double b, double fb) {
    for (int i = 0; i < 200; ++i) {
      if (fb == 0.0 || std::abs(b - a) <= 4e-16 * std::max(std::abs(a), std::abs(b))) return b;
      double c = (i % 8 == 7) ? 0.5 * (a + b) : b - fb * (b - a) / (fb - fa);
      if (!(c > std::min(a, b) && c < std::max(a, b))) c = 0.5 * (a + b);
      if (c == a || c == b) return c;
      const double fc = f(c);
      if ((fc < 0.0) != (fb < 0.0)) {
        a = b;
        fa = fb;
      } else {
        fa *= 0.5;
      }
      b = c;
      fb = fc;
    }
    return b;
  }

  BristleFriction law_;
  double time_step_;
  double slip_;
  std::uint64_t turns_ = 0;
};

}  // namespace modcal
