// Event-driven stepping of the bowed string: stretches of sliding and of adherence, joined at
// switches located inside the step.
#pragma once

#include "libsim/base/task_loop.hpp"
#include "libsim/dynamics/event/modes/bow_path.hpp"
#include "libsim/dynamics/event/modes/closed_loop.hpp"

namespace modcal::event {

/// State of the adherence spring at the instant of attachment.
enum class AttachRule {
  kLiteral,     ///< y_c = 0: the force starts at 0 (Debut, Delaune and Antunes, 2010, eq. 8)
  kContinuous,  ///< y_c = −f/K_a: the force continues from the sliding limit
};

/// String and contact at one instant.
struct EventState {
  PlanarVector modes;  ///< Z
  bool sticking = false;
  double elongation = 0.0;  ///< y_c of the adherence spring [m], while sticking
  double side = -1.0;       ///< sgn v_c, while sliding
  double rise = 0.0;        ///< temperature rise of a contact that has one [K]
};

/// Hysteresis: adherence ends only at |f| = μ_S F_N, sliding only at v_c = 0; between these limits
/// the state stays what it is. A released string slides with the sign of its v_c; at v_c = 0
/// against the force that held it.
/// Where the load is 0 there is no contact: the string moves freely, and slides with the sign of
/// its v_c when the load comes back.
struct EventLoop {
  ContactParameters contact;
  SlidingLaw law;
  /// In the place of `law` and of contact.static_limit, where the friction depends on the
  /// temperature; `bow` then tells the normal force [N] as the load. The contact starts with
  /// EventState::rise.
  std::optional<ThermalSliding> thermal;
  /// MotionSample of the bow; empty: steady at contact.bow_velocity. Otherwise its velocity stands
  /// in the place of that one, and law and contact.static_limit are those of load 1.
  std::vector<BowKnot> bow;
  AttachRule attach = AttachRule::kLiteral;
  int nodes = 5;               ///< Lobatto nodes of a sliding step, 2 … 5: order 2(nodes − 1)
  double slope_number = 0.35;  ///< κ, largest |g'| h/m_eff of a sliding step
  double tail_ratio = 0.3;     ///< r, how fast the powers of the force in a sliding step fall
  double grid_step = 0.0;      ///< longest step [s]
  std::size_t steps_per_sample = 1;
  std::size_t samples = 0;  ///< samples, that of the start included
  SampleTargets targets;    ///< sample j is taken after j·steps_per_sample grid steps
  SwitchList switches;
  /// Sees every piece of the force and every switch; null: nobody does, at no cost.
  ForceObserver* observer = nullptr;
  StopToken stop;  ///< polled between samples

  /// The bow's motion, a steady one as well.
  std::vector<BowKnot> knots() const {
    if (!bow.empty()) return bow;
    return {{.time = 0.0, .velocity = contact.bow_velocity, .load = 1.0}};
  }
};

/// Who observes a run: begin() sees what is about to run and returns the observer, end() sees the
/// state that a run reaches which does not stop early.
struct Watch {
  std::function<ForceObserver*(const EventLoop&, const ContactModes&, const EventState&)> begin;
  std::function<void(const EventState&)> end;
};

struct EventCounts {
  std::size_t attachments = 0;
  std::size_t releases = 0;
  /// Releases at which the string already moved against the slip that the force asked for.
  std::size_t wrong_sign_releases = 0;
  std::size_t steps = 0;
  std::size_t refined_steps = 0;  ///< sliding steps taken back for shorter ones
  /// Why the run stopped early, and when [s].
  std::optional<std::string> failure;
  double failed_at = 0.0;
};

/// The state with the given modes: sticking with an unstretched spring where v_c = 0.
inline EventState initial_state(const ContactModes& modes, double bow_velocity) {
  EventState state;
  state.modes = PlanarVector(modes.initial);
  const double velocity = motion_of(modes, modes.initial).velocity;
  state.sticking = velocity == bow_velocity;
  state.side = velocity < bow_velocity ? -1.0 : 1.0;
  return state;
}

/// Advances the state over all samples. Throws InvalidInput where the contact cannot be computed
/// at all: a double root of the closed loop, or a root that turns by more than 1e4 rad in a step.
EventCounts run_event_loop(const EventLoop& loop, const ContactModes& modes, EventState& state);

}  // namespace modcal::event
