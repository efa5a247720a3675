#include "libsim/dynamics/event/event_loop.hpp"

#include "libsim/dynamics/event/sliding/sliding.hpp"
#include "libsim/dynamics/event/sticking.hpp"
#include "libsim/dynamics/event/tuning.hpp"

namespace modcal::event {
namespace {

// More switches, and more steps, in one grid step than any regular motion makes.
constexpr int kMaxSwitches = 200, kMaxStepsPerGridStep = 1'000'000;

template <typename Friction>
class Run {
 public:
  Run(const EventLoop& loop, const Friction& friction, const LobattoRule& rule,
      const ContactModes& modes, std::optional<Sticking> sticking, EventState& state)
      : loop_(loop),
        state_(state),
        clock_(loop.knots(), loop.grid_step),
        model_(modes, rule, loop.grid_step),
        sliding_(model_, friction, loop.slope_number, loop.tail_ratio),
        sticking_(std::move(sticking)) {}

  EventCounts run() {
    enter();
    store(0);
    for (std::size_t sample = 1; sample < loop_.samples && !counts_.failure; ++sample) {
      if (loop_.stop.requested()) break;
      loop_.stop.tell(sample, loop_.samples);
      if (const std::size_t held = hold_block(sample); held > 0) {
        sample += held - 1;
        continue;
      }
      for (std::size_t i = 0; i < loop_.steps_per_sample && !counts_.failure; ++i) {
        grid_step(i + 1 == loop_.steps_per_sample);
        clock_.pass(1);
      }
      if (!counts_.failure) store(sample);
    }
    leave();
    counts_.refined_steps = sliding_.refined_steps();
    return counts_;
  }

 private:
  void enter() {
    law().set_rise(state_.rise);
    in_contact_ = sticking_ && !clock_.drive().lifted();
    if (!in_contact_) {
      clock_.mark_base(0.0);
      return;
    }
    const MotionSample motion = model_.observe(state_.modes, {});
    const BowDrive drive = clock_.drive_at(0.0);
    if (state_.sticking) {
      hold(0.0, drive, motion.displacement, state_.elongation);
    } else {
      sliding_.start(state_.side, state_.side * (motion.velocity - drive.velocity), drive.load);
    }
  }

  void leave() {
    const double tau = clock_.since_base(0.0);
    if (!in_contact_) law().cool(tau);
    state_.rise = law().rise();
    if (!in_contact_) return;
    state_.side = sliding_.side();
    if (!state_.sticking) return;
    state_.rise = sticking_->rise(tau);
    sticking_->detach(tau, state_.modes);
    state_.elongation = sticking_->elongation(tau, model_.observe(state_.modes, {}).displacement);
  }

  void enter_stretch(double x) {
    clock_.enter_stretch();
    const bool contact = sticking_ && !clock_.drive().lifted();
    if (in_contact_ && contact && state_.sticking) {
      sticking_->change_drive(clock_.since_base(x), clock_.drive());
      clock_.mark_base(x);
    }
    if (in_contact_ && !contact) {
      if (state_.sticking) let_go(x);
      clock_.mark_base(x);
    }
    if (!in_contact_ && contact) touch_down(x);
    in_contact_ = contact;
  }

  // The contact at y sticks from x on.
  void hold(double x, const BowDrive& drive, double y, double elongation) {
    sticking_->attach(drive, state_.modes, y, elongation, law().rise());
    clock_.mark_base(x);
    state_.sticking = true;
  }

  void let_go(double x) {
    const double tau = clock_.since_base(x);
    sticking_->detach(tau, state_.modes);
    law().set_rise(sticking_->rise(tau));
    state_.sticking = false;
    if (loop_.observer != nullptr) loop_.observer->released();
  }

  // The bow comes back: it holds the string where both move alike, else the string slides.
  void touch_down(double x) {
    law().cool(clock_.since_base(x));
    const MotionSample motion = model_.observe(state_.modes, {.reactions = false});
    const BowDrive drive = clock_.drive();
    const double slip = motion.velocity - drive.velocity;
    if (slip == 0.0) {
      hold(x, drive, motion.displacement, 0.0);
      if (loop_.observer != nullptr) loop_.observer->attached(0.0);
    } else {
      state_.sticking = false;
      sliding_.start(slip < 0.0 ? -1.0 : 1.0, std::abs(slip), drive.load);
    }
  }

  void grid_step(bool sampled) {
    double x = 0.0;
    int switches = 0;
    for (int parts = 0; x < 1.0; ++parts) {
      const double last = clock_.cut();
      if (last - x < kSamePoint) {
        enter_stretch(x);
        continue;
      }
      const std::size_t before = counts_.attachments + counts_.releases;
      x = part(x, last, sampled);
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

  // From x to `last` at most.
  double part(double x, double last, bool sampled) {
    if (in_contact_) return state_.sticking ? stick(x, last, sampled) : slide(x, last);
    if (loop_.observer != nullptr)
      loop_.observer->piece({.duration = (last - x) * loop_.grid_step});
    if (x == 0.0 && last == 1.0) {
      model_.advance_free(state_.modes);
    } else {
      model_.advance_free_by((last - x) * loop_.grid_step, state_.modes);
    }
    return last;
  }

  // Samples that follow each other while the string sticks, some at once. Returns how many.
  std::size_t hold_block(std::size_t sample) {
    if (!in_contact_ || !state_.sticking || loop_.steps_per_sample != 1) return 0;
    if (loop_.samples - sample < Sticking::kBlock) return 0;
    if (clock_.cut_within(Sticking::kBlock)) return 0;
    const double tau = clock_.since_base(0.0);
    if (loop_.observer != nullptr) before_ = sticking_->state();
    const std::size_t held = sticking_->advance_block(tau, block_);
    if (loop_.observer != nullptr) {
      sticking_->show(before_, tau, static_cast<double>(held) * loop_.grid_step, *loop_.observer);
    }
    block_.write(loop_.targets, sample, held);
    counts_.steps += held;
    clock_.pass(held);
    return held;
  }

  double stick(double x, double last, bool sampled) {
    const double remaining = (last - x) * loop_.grid_step;
    if (loop_.observer != nullptr) before_ = sticking_->state();
    const auto result = sticking_->advance(clock_.since_base(x), remaining, sampled && last == 1.0);
    if (loop_.observer != nullptr) {
      sticking_->show(before_, clock_.since_base(x), result.time, *loop_.observer);
    }
    if (!std::isfinite(sticking_->force())) {
      fail(x, "the contact force is not a finite number");
      return x;
    }
    const double reached = result.time >= remaining ? last : x + result.time / loop_.grid_step;
    if (result.released != 0) release(reached, result.released);
    return reached;
  }

  double slide(double x, double last) {
    using Outcome = typename Sliding<Friction>::Outcome;
    const auto result = sliding_.advance(x, last, clock_.drive_at(x), state_.modes);
    if (loop_.observer != nullptr && result.position > x) {
      sliding_.show(clock_.drive_at(x), *loop_.observer);
    }
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
    const BowDrive drive = clock_.drive_at(x);
    const bool continuous = loop_.attach == AttachRule::kContinuous;
    const double force = -sliding_.side() * law().at(0.0, drive.load).friction;
    const double elongation = continuous ? -force / loop_.contact.stiffness : 0.0;
    hold(x, drive, y, elongation);
    if (loop_.observer != nullptr) loop_.observer->attached(elongation);
    loop_.switches.add({clock_.time_at(x), y, true});
    ++counts_.attachments;
  }

  // `limit`: the sign of the force that adherence could not carry.
  void release(double x, int limit) {
    let_go(x);
    const MotionSample motion = model_.observe(state_.modes, {.reactions = false});
    const double v = motion.velocity;
    loop_.switches.add({clock_.time_at(x), motion.displacement, false});
    const BowDrive drive = clock_.drive_at(x);
    const double slip = v - drive.velocity;
    const double against_force = -limit;
    const bool at_rest = std::abs(slip) <= kAtRest * (std::abs(v) + std::abs(drive.velocity));
    const double side = at_rest ? against_force : slip < 0.0 ? -1.0 : 1.0;
    if (side != against_force) ++counts_.wrong_sign_releases;
    sliding_.start(side, at_rest ? 0.0 : std::abs(slip), drive.load);
    ++counts_.releases;
  }

  Friction& law() { return sliding_.friction(); }

  void fail(double x, std::string reason) {
    counts_.failure = std::move(reason);
    counts_.failed_at = clock_.time_at(x);
  }

  void store(std::size_t sample) {
    MotionSample motion;
    if (state_.sticking && in_contact_) {
      motion = sticking_->observe(clock_.since_base(0.0));
    } else {
      motion = model_.observe(state_.modes, loop_.targets.wanted());
      if (in_contact_) motion.force = sliding_.force();
    }
    if (!std::isfinite(motion.velocity) || !std::isfinite(motion.force)) {
      return fail(0.0, "the motion is not a finite number");
    }
    loop_.targets.write(sample, motion);
  }

  const EventLoop& loop_;
  EventState& state_;
  BowClock clock_;
  SlidingModel model_;
  Sliding<Friction> sliding_;
  std::optional<Sticking> sticking_;
  bool in_contact_ = false;
  EventCounts counts_;
  Sticking::Block block_;  // the samples of a held block
  PlanarVector before_;    // what the held string was when it moved on, for the observer
};

}  // namespace

EventCounts run_event_loop(const EventLoop& loop, const ContactModes& modes, EventState& state) {
  const LobattoRule rule = lobatto_rule(loop.nodes);
  const double mass = modes.effective_mass();
  // A bow that cannot carry any force is not there: without contact and switches.
  std::optional<Sticking> sticking;
  if (loop.contact.static_limit > 0.0) {
    sticking = held_string(
        modes, loop.contact,
        loop.thermal ? StaticLimit(*loop.thermal) : StaticLimit(loop.contact.static_limit),
        loop.grid_step, loop.targets.wanted());
  }
  const auto run = [&](auto friction) {
    return Run<decltype(friction)>(loop, friction, rule, modes, std::move(sticking), state).run();
  };
  if (loop.thermal) return run(ThermalFriction(*loop.thermal, rule, mass));
  return std::visit([&](const auto& law) { return run(CurveFriction(law, rule, mass)); }, loop.law);
}

}  // namespace modcal::event
