// Stick–slip rule of one contact point on a fixed time grid, as plain values for the step loop.
//
// Sliding with sign side = sgn(v_c): f = −side·g(|v_c|). The string attaches at the first step at
// which v_c has changed sign (y_c = 0 there: the paper's literal rule) and is released at the first
// step at which |−K_a y_c − C_a v_c| exceeds μ_S F_N (Debut, Delaune and Antunes, 2010, eqs. 5–8).
#pragma once

#include "libsim/dynamics/fixed_step/step_loop.hpp"

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

  /// Response of v [m/(N s)] and y [m/N] to the newest force of a step (`newest`) and to the one
  /// before (`older`), for implicit_force() and the steps that go on as before.
  void set_response(const MotionSample& newest, const MotionSample& older) {
    b_ = newest.velocity;
    b_y_ = newest.displacement;
    older_ = older;
    const double held = 1.0 / (1.0 + p_.stiffness * b_y_ + p_.damping * b_);
    held_stiffness_ = held * p_.stiffness;
    held_damping_ = held * p_.damping;
    held_older_ = -(held_stiffness_ * older.displacement + held_damping_ * older.velocity);
    caught_ = 1.0 / (1.0 + p_.damping * b_);
    if constexpr (kHasClosedForm) closed_form_ = typename Law::ClosedForm(law_, b_);
    restart(speed_[0]);
  }

  void list_switches(const SwitchList& list) { switch_list_ = list; }

  std::uint64_t attachments() const { return attachments_; }
  std::uint64_t releases() const { return releases_; }

  /// Force at t = 0.
  double initial_force() const { return sticking_ ? 0.0 : -side_ * law_.at(speed_[0]).force; }

  bool sticking() const { return sticking_; }

  /// Spring [N/m] and damper [N s/m] whose force on P is all that a sticking step asks of the
  /// modes: those of the adherence, for a force solved for shared between contact and string.
  struct Spring {
    double stiffness = 0.0, damping = 0.0;
  };
  Spring implicit_spring() const { return {held_stiffness_, held_damping_}; }
  Spring explicit_spring() const { return {p_.stiffness, p_.damping}; }

  /// The force while the contact sticks, a line in the number j of steps since `k` less the force
  /// of the spring on P: bow + bow_per_step j − spring(P) + newest f_{k−1} + older f_{k−2}.
  struct Held {
    double bow = 0.0, bow_per_step = 0.0;
    double newest = 0.0, older = 0.0;
    double limit = 0.0;
  };
  Held implicit_held(std::uint64_t k) const {
    Held held = held_by(implicit_spring(), k);
    held.newest = held_older_;
    return held;
  }
  Held explicit_held(std::uint64_t k) const {
    Held held = held_by(explicit_spring(), k);
    held.newest = -(p_.stiffness * b_y_ + p_.damping * b_);
    held.older = -(p_.stiffness * older_.displacement + p_.damping * older_.velocity);
    return held;
  }

  /// The force of a step in which the contact goes on sliding as before; false where that is not
  /// known: then ask explicit_force() or implicit_force(). Without a call, which would push the
  /// modes out of the step loop's registers. `v0` is the velocity of P, without the forces of the
  /// two steps before.
  bool explicit_slides_on(double v0, double newest, double older, double& force) const {
    const double slip = (v0 - p_.bow_velocity) + older_.velocity * older + b_ * newest;
    force = -side_ * law_.at(std::abs(slip)).force;
    return slip * side_ > 0.0;
  }
  bool implicit_slides_on(double v0, double newest, double& force) const {
    if constexpr (kHasClosedForm) {
      if (!closed_form_.valid()) return false;
      const double slip = (v0 + older_.velocity * newest) - p_.bow_velocity;
      force = closed_force(v0, newest);
      return side_ * slip >= b_ * rest_force_;
    }
    return false;
  }

  /// Force for the known velocity v and displacement y of step k.
  [[gnu::noinline]] double explicit_force(double v, double y, std::uint64_t k) {
    const double slip = v - p_.bow_velocity;
    if (sticking_) {
      const double force = -p_.stiffness * elongation(y, k) - p_.damping * slip;
      if (std::abs(force) <= p_.static_limit) return force;
      release(slip != 0.0 ? slip : -force, y, k);
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

  /// Force that solves f = F(v) at the end of step k, where v = v₀ + d f_older + b f and
  /// y = y₀ + d_y f_older + b_y f. What is known before f_older, that is v₀ and y₀, is put together
  /// apart: the chain of dependent operations from step to step stays short.
  [[gnu::noinline]] double implicit_force(double v0, double y0, double older, std::uint64_t k) {
    const double slip = (v0 + older_.velocity * older) - p_.bow_velocity;
    if (sticking_) {
      // The bow's part first: it needs nothing of this step.
      const double bow = held_stiffness_ * bow_displacement(k) + held_damping_ * p_.bow_velocity;
      const double force =
          ((bow - held_stiffness_ * y0) - held_damping_ * v0) + held_older_ * older;
      if (std::abs(force) <= p_.static_limit) return force;
      release(-force, y0 + older_.displacement * older + b_y_ * force, k);
      restart(0.0);
    } else if (side_ * slip < b_ * rest_force_) {
      const double force = -p_.damping * slip * caught_;
      if (std::abs(force) <= p_.static_limit) {
        attach(y0 + older_.displacement * older + b_y_ * force, k);
        return force;
      }
      side_ = -side_;
    }
    return sliding_force_of(v0, older, slip);
  }

 private:
  // Where the adherence spring is unstretched at step k.
  double bow_displacement(std::uint64_t k) const {
    const double elapsed = time_step_ * static_cast<double>(k - attach_step_);
    return attach_displacement_ + p_.bow_velocity * elapsed;
  }
  double elongation(double y, std::uint64_t k) const { return y - bow_displacement(k); }
  Held held_by(const Spring& spring, std::uint64_t k) const {
    return {.bow = spring.stiffness * bow_displacement(k) + spring.damping * p_.bow_velocity,
            .bow_per_step = spring.stiffness * p_.bow_velocity * time_step_,
            .limit = p_.static_limit};
  }
  void attach(double y, std::uint64_t k) {
    sticking_ = true;
    attach_displacement_ = y;
    attach_step_ = k;
    ++attachments_;
    list_switch(y, k);
  }
  void release(double direction, double y, std::uint64_t k) {
    sticking_ = false;
    side_ = direction < 0.0 ? -1.0 : 1.0;
    ++releases_;
    list_switch(y, k);
  }
  void list_switch(double y, std::uint64_t k) const {
    switch_list_.add({time_step_ * static_cast<double>(k), y, sticking_});
  }
  // The solution of u + b g(u) = w near w₀ = u₀ + b g(u₀), prepared before w is known: with
  // ρ = (w − w₀)/(1 + b g'), u − u₀ = δ = ρ (1 + bend ρ) is one step of Halley's iteration.
  struct Expansion {
    double speed = 0.0, right_side = 0.0;  // u₀, w₀
    double inverse_slope = 1.0, bend = 0.0;
    typename Law::Point point{};
  };
  Expansion expansion_at(double speed) const {
    Expansion at{.speed = speed > 0.0 ? speed : 0.0};
    at.point = law_.at(at.speed);
    at.right_side = at.speed + b_ * at.point.force;
    at.inverse_slope = 1.0 / (1.0 + b_ * at.point.slope);
    at.bend = -0.5 * b_ * at.point.curvature * at.inverse_slope;
    return at;
  }
  static double change(const Expansion& at, double w) {
    const double linear = (w - at.right_side) * at.inverse_slope;
    return linear + at.bend * (linear * linear);
  }
  // Where the change δ is carried over to the force by the law's parabola, it leaves
  // |δ³ g'''|/6 ≤ 1e-15 · 0.23 g(0) for an exponential law: rounding.
  static bool close(double change, double speed) { return std::abs(change) <= 1e-5 * speed; }
  static double force_after(const Expansion& at, double change) {
    return at.point.force + change * (at.point.slope + 0.5 * change * at.point.curvature);
  }

  // Sliding begins, or goes on from an unsteady step, at this speed.
  void restart(double speed) {
    for (double& past : speed_) past = speed;
    for (Expansion& expansion : ahead_) expansion = expansion_at(speed);
  }

  // The force of a step that slides with this slip before its own force.
  double sliding_force_of(double v0, double older, double slip) {
    if constexpr (kHasClosedForm) {
      if (closed_form_.valid() && side_ * slip >= b_ * rest_force_) return closed_force(v0, older);
    }
    return -side_ * sliding_force(side_ * slip);
  }
  double closed_force(double v0, double older) const {
    return closed_form_.force(side_, v0 - p_.bow_velocity, older_.velocity * side_, older);
  }

  // Force at the root u ≥ 0 of u + b g(u) = w: Halley's iteration on a convex function that rises
  // because b·|g'| < 1 (the simulator refuses larger steps). It starts from the law at a speed
  // extrapolated two steps ahead (by the quintic through the last six): that exponential does not
  // wait for the running step.
  // Without a root at u ≥ 0 (the release would start in the wrong direction) the force stays at the
  // limit for this step.
  double sliding_force(double w) {
    if (!(w > b_ * rest_force_)) {
      restart(0.0);
      return rest_force_;
    }
    Expansion at = ahead_[0];
    double force = rest_force_, u = at.speed;
    for (int iteration = 0; iteration < 50; ++iteration) {
      const double wanted = at.speed + change(at, w);
      u = wanted > 0.0 ? wanted : 0.0;
      const double step = u - at.speed;
      force = force_after(at, step);
      if (close(step, u)) break;
      at = expansion_at(u);
    }
    for (int i = kPast - 1; i > 0; --i) speed_[i] = speed_[i - 1];
    speed_[0] = u;
    ahead_[0] = ahead_[1];
    ahead_[1] =
        expansion_at((21.0 * u - 70.0 * speed_[1]) + (105.0 * speed_[2] - 84.0 * speed_[3]) +
                     (35.0 * speed_[4] - 6.0 * speed_[5]));
    return force;
  }

  static constexpr bool kHasClosedForm = requires { typename Law::ClosedForm; };
  template <typename L>
  struct ClosedFormOf {
    struct Type {};
  };
  template <typename L>
  requires requires { typename L::ClosedForm; }
  struct ClosedFormOf<L> {
    using Type = typename L::ClosedForm;
  };

  ContactParameters p_;
  Law law_;
  double time_step_;
  double rest_force_;  // g(0)
  double b_ = 0.0, b_y_ = 0.0, caught_ = 1.0;
  double held_stiffness_ = 0.0, held_damping_ = 0.0, held_older_ = 0.0;
  MotionSample older_;
  bool sticking_ = false;
  double side_ = -1.0;
  double attach_displacement_ = 0.0;
  std::uint64_t attach_step_ = 0;
  typename ClosedFormOf<Law>::Type closed_form_;
  // Fixed by: speeds that determine the quintic of sliding_force().
  static constexpr int kPast = 6;
  double speed_[kPast] = {};  // the last sliding speeds, newest first
  Expansion ahead_[2];        // for the next step and the one after
  std::uint64_t attachments_ = 0;
  std::uint64_t releases_ = 0;
  SwitchList switch_list_;
};

/// The rule of a run, and in `coefficients` the spring that the loop asks of the modes.
template <typename Law>
ContactRule<Law> make_rule(const FixedStepRun& run, const SteadyContact& contact, const Law& law,
                           StepCoefficients& coefficients) {
  ContactRule<Law> rule(contact.parameters, law, run.time_step, contact.initial_displacement,
                        contact.initial_velocity);
  rule.list_switches(run.switches);
  rule.set_response(coefficients.direct_response, coefficients.deferred_response);
  const auto spring =
      run.timing == ForceTiming::kImplicit ? rule.implicit_spring() : rule.explicit_spring();
  coefficients.hold(spring.stiffness, spring.damping);
  return rule;
}

}  // namespace modcal
