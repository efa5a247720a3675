#include "libsim/dynamics/event/event_loop.hpp"

#include <fmt/format.h>

#include <cmath>

#include "libsim/base/error.hpp"
#include "libsim/dynamics/event/sliding.hpp"
#include "libsim/dynamics/event/sticking.hpp"

namespace modcal::event {
namespace {

// More switches in one grid step than any regular motion makes.
constexpr int kMaxSwitches = 200;
constexpr int kMaxStepsPerGridStep = 1'000'000;
constexpr double kMaxPhase = 1e4;
// |v_c| below this share of the velocities at hand is zero.
constexpr double kAtRest = 1e-14;

ClosedLoop closed_loop_for(const EventLoop& loop, const ContactModes& modes) {
  const ContactParameters& contact = loop.contact;
  auto closed = make_closed_loop(modes, contact.stiffness, contact.damping);
  MODCAL_REQUIRE(closed.has_value(),
                 "adherence of {:g} N/m and {:g} N s/m gives the held string a double root, which "
                 "its exact propagator cannot resolve; change the damping slightly",
                 contact.stiffness, contact.damping);
  MODCAL_REQUIRE(closed->largest_pole * loop.grid_step <= kMaxPhase,
                 "adherence of {:g} N/m and {:g} N s/m has a pole of {:g} 1/s: more than {:g} "
                 "radians in a step of {:g} s; shorten the step or soften the contact",
                 contact.stiffness, contact.damping, closed->largest_pole, kMaxPhase,
                 loop.grid_step);
  return std::move(*closed);
}

template <typename Law>
class Run {
 public:
  Run(const EventLoop& loop, const Law& law, const ContactModes& modes, EventState& state)
      : loop_(loop),
        state_(state),
        wanted_{.contact = loop.targets.displacement || loop.targets.velocity,
                .reactions = loop.targets.left_reaction || loop.targets.right_reaction},
        model_(modes, lobatto_rule(loop.nodes), loop.grid_step),
        sliding_(model_, law, loop.contact.bow_velocity, loop.slope_number),
        friction_at_rest_(law.at(0.0).force) {
    // A bow that cannot carry any force is not there: no contact, no switches.
    if (loop.contact.static_limit > 0.0) {
      sticking_.emplace(closed_loop_for(loop, modes), loop.contact.bow_velocity,
                        loop.contact.static_limit, loop.grid_step, wanted_);
    }
  }

  EventCounts run() {
    enter();
    store(0, 0.0);
    for (std::size_t sample = 1; sample < loop_.samples && !counts_.failure; ++sample) {
      if (const std::size_t held = hold_block(sample); held > 0) {
        sample += held - 1;
        continue;
      }
      for (std::size_t i = 0; i < loop_.steps_per_sample && !counts_.failure; ++i) {
        grid_step(i + 1 == loop_.steps_per_sample);
        ++step_;
      }
      if (!counts_.failure) store(sample, 0.0);
    }
    leave();
    return counts_;
  }

 private:
  void enter() {
    const Motion motion = model_.observe(state_.modes, {});
    if (!sticking_) return;
    if (state_.sticking) {
      sticking_->attach(state_.modes, motion.displacement, state_.elongation);
      mark_attachment(0.0);
    } else {
      sliding_.start(state_.side, state_.side * (motion.velocity - loop_.contact.bow_velocity));
    }
  }

  void leave() {
    if (!sticking_) return;
    state_.side = sliding_.side();
    if (!state_.sticking) return;
    const double tau = elapsed(0.0);
    sticking_->detach(tau, state_.modes);
    const double displacement = model_.observe(state_.modes, {}).displacement;
    state_.elongation = displacement - sticking_->rest_point() - loop_.contact.bow_velocity * tau;
  }

  void grid_step(bool sampled) {
    if (!sticking_) {
      model_.advance_free(state_.modes);
      ++counts_.steps;
      return;
    }
    double x = 0.0;
    int switches = 0;
    for (int parts = 0; x < 1.0; ++parts) {
      const std::size_t before = counts_.attachments + counts_.releases;
      x = state_.sticking ? stick(x, sampled) : slide(x);
      if (counts_.failure) return;
      ++counts_.steps;
      switches += static_cast<int>(counts_.attachments + counts_.releases - before);
      if (switches > kMaxSwitches) {
        return fail(x, fmt::format("more than {} switches between sticking and sliding in {:g} s: "
                                   "the contact chatters",
                                   kMaxSwitches, loop_.grid_step));
      }
      if (parts > kMaxStepsPerGridStep) {
        return fail(x, fmt::format("the friction law is so steep that {:g} s take more than {} "
                                   "steps",
                                   loop_.grid_step, kMaxStepsPerGridStep));
      }
    }
  }

  // Samples that follow each other while the string sticks, some at once. Returns how many.
  std::size_t hold_block(std::size_t sample) {
    if (!state_.sticking || !sticking_ || loop_.steps_per_sample != 1) return 0;
    if (loop_.samples - sample < Sticking::kBlock) return 0;
    Sticking::Block motions;
    const std::size_t held = sticking_->advance_block(elapsed(0.0), motions);
    for (std::size_t k = 0; k < held; ++k) store(sample + k, motions[k]);
    counts_.steps += held;
    step_ += held;
    return held;
  }

  double stick(double x, bool sampled) {
    const double remaining = (1.0 - x) * loop_.grid_step;
    const auto result = sticking_->advance(elapsed(x), remaining, sampled);
    if (!std::isfinite(sticking_->force())) {
      fail(x, "the contact force is not a finite number");
      return x;
    }
    const double reached = result.time >= remaining ? 1.0 : x + result.time / loop_.grid_step;
    if (result.released) release(reached);
    return reached;
  }

  double slide(double x) {
    using Outcome = typename Sliding<Law>::Outcome;
    const auto result = sliding_.advance(x, state_.modes);
    if (result.outcome == Outcome::kFailed) {
      fail(x,
           "the friction equation has no solution on any step: the force falls too steeply with "
           "the speed, or the state is not finite");
      return x;
    }
    if (result.outcome == Outcome::kAttached) attach(result.position);
    return result.position;
  }

  void attach(double x) {
    const double y = model_.observe(state_.modes, {.reactions = false}).displacement;
    const bool continuous = loop_.attach == AttachRule::kContinuous;
    const double force = -sliding_.side() * friction_at_rest_;
    sticking_->attach(state_.modes, y, continuous ? -force / loop_.contact.stiffness : 0.0);
    mark_attachment(x);
    state_.sticking = true;
    ++counts_.attachments;
  }

  void release(double x) {
    sticking_->detach(elapsed(x), state_.modes);
    const double v = model_.observe(state_.modes, {.reactions = false}).velocity;
    const double slip = v - loop_.contact.bow_velocity;
    const double against_force = sticking_->force() > 0.0 ? -1.0 : 1.0;
    const bool at_rest =
        std::abs(slip) <= kAtRest * (std::abs(v) + std::abs(loop_.contact.bow_velocity));
    const double side = at_rest ? against_force : slip < 0.0 ? -1.0 : 1.0;
    if (side != against_force) ++counts_.wrong_sign_releases;
    sliding_.start(side, at_rest ? 0.0 : std::abs(slip));
    state_.sticking = false;
    ++counts_.releases;
  }

  void mark_attachment(double x) {
    attach_step_ = step_;
    attach_position_ = x;
  }
  // Time since the attachment [s], at x in the running grid step.
  double elapsed(double x) const {
    return (static_cast<double>(step_ - attach_step_) + (x - attach_position_)) * loop_.grid_step;
  }

  void fail(double x, std::string reason) {
    counts_.failure = std::move(reason);
    counts_.failed_at = (static_cast<double>(step_) + x) * loop_.grid_step;
  }

  void store(std::size_t sample, double x) {
    Motion motion;
    if (state_.sticking && sticking_) {
      motion = sticking_->observe(elapsed(x));
    } else {
      motion = model_.observe(state_.modes, wanted_);
      if (sticking_) motion.force = sliding_.force();
    }
    if (!std::isfinite(motion.velocity) || !std::isfinite(motion.force)) {
      return fail(x, "the motion is not a finite number");
    }
    store(sample, motion);
  }

  void store(std::size_t sample, const Motion& motion) {
    const SampleTargets& to = loop_.targets;
    if (to.displacement) to.displacement[sample] = motion.displacement;
    if (to.velocity) to.velocity[sample] = motion.velocity;
    if (to.force) to.force[sample] = motion.force;
    if (to.left_reaction) to.left_reaction[sample] = motion.left;
    if (to.right_reaction) to.right_reaction[sample] = motion.right;
  }

  const EventLoop& loop_;
  EventState& state_;
  MotionRequest wanted_;
  SlidingModel model_;
  Sliding<Law> sliding_;
  std::optional<Sticking> sticking_;
  double friction_at_rest_;
  EventCounts counts_;
  std::uint64_t step_ = 0, attach_step_ = 0;
  double attach_position_ = 0.0;
};

}  // namespace

EventState initial_state(const ContactModes& modes, double bow_velocity) {
  EventState state;
  state.modes = PlanarVector(modes.size());
  double velocity = 0.0;
  for (std::size_t n = 0; n < modes.size(); ++n) {
    state.modes.set(n, modes.initial[n]);
    velocity += modes.initial[n].real() - modes.quadrature[n] * modes.initial[n].imag();
  }
  state.sticking = velocity == bow_velocity;
  state.side = velocity < bow_velocity ? -1.0 : 1.0;
  return state;
}

EventCounts run_event_loop(const EventLoop& loop, const ContactModes& modes, EventState& state) {
  return std::visit(
      [&](const auto& law) {
        using Law = std::decay_t<decltype(law)>;
        return Run<Law>(loop, law, modes, state).run();
      },
      loop.law);
}

}  // namespace modcal::event
