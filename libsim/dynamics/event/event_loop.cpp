#include "libsim/dynamics/event/event_loop.hpp"

#include <fmt/format.h>

#include <algorithm>
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
// Positions in a grid step closer than this are one.
constexpr double kSamePoint = 1e-13;

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

std::vector<BowKnot> knots_of(const EventLoop& loop) {
  if (!loop.bow.empty()) return loop.bow;
  return {{.time = 0.0, .velocity = loop.contact.bow_velocity, .load = 1.0}};
}

template <typename Friction>
class Run {
 public:
  Run(const EventLoop& loop, const Friction& friction, const LobattoRule& rule,
      const ContactModes& modes, EventState& state)
      : loop_(loop),
        state_(state),
        path_(knots_of(loop), loop.grid_step),
        stretch_(path_.stretches().data()),
        last_stretch_(stretch_ + path_.stretches().size() - 1),
        wanted_{.contact = loop.targets.displacement || loop.targets.velocity,
                .reactions = loop.targets.left_reaction || loop.targets.right_reaction},
        model_(modes, rule, loop.grid_step),
        sliding_(model_, friction, loop.slope_number, loop.tail_ratio) {
    // A bow that cannot carry any force is not there: no contact, no switches.
    if (loop.contact.static_limit > 0.0) {
      sticking_.emplace(
          closed_loop_for(loop, modes),
          loop.thermal ? StaticLimit(*loop.thermal) : StaticLimit(loop.contact.static_limit),
          loop.grid_step, wanted_);
    }
  }

  EventCounts run() {
    enter();
    store(0);
    for (std::size_t sample = 1; sample < loop_.samples && !counts_.failure; ++sample) {
      if (loop_.stop.requested()) break;
      if (const std::size_t held = hold_block(sample); held > 0) {
        sample += held - 1;
        continue;
      }
      for (std::size_t i = 0; i < loop_.steps_per_sample && !counts_.failure; ++i) {
        grid_step(i + 1 == loop_.steps_per_sample);
        ++step_;
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
    in_contact_ = sticking_ && !stretch_->drive.lifted();
    if (!in_contact_) {
      mark_base(0.0);
      return;
    }
    const Motion motion = model_.observe(state_.modes, {});
    const BowDrive drive = drive_at(0.0);
    if (state_.sticking) {
      sticking_->attach(drive, state_.modes, motion.displacement, state_.elongation, state_.rise);
      mark_base(0.0);
    } else {
      sliding_.start(state_.side, state_.side * (motion.velocity - drive.velocity), drive.load);
    }
  }

  void leave() {
    const double tau = since_base(0.0);
    if (!in_contact_) law().cool(tau);
    state_.rise = law().rise();
    if (!in_contact_) return;
    state_.side = sliding_.side();
    if (!state_.sticking) return;
    state_.rise = sticking_->rise(tau);
    sticking_->detach(tau, state_.modes);
    state_.elongation = sticking_->elongation(tau, model_.observe(state_.modes, {}).displacement);
  }

  // The bow's drive counted from x in the running grid step.
  BowDrive drive_at(double x) const { return stretch_->drive.from(since(stretch_->start, x)); }
  double since(GridPoint start, double x) const {
    return (static_cast<double>(step_ - start.step) + (x - start.x)) * loop_.grid_step;
  }

  // Where the running grid step is cut by the next stretch; 1: not at all.
  double cut() const {
    if (stretch_ == last_stretch_) return 1.0;
    const GridPoint next = (stretch_ + 1)->start;
    return next.step == step_ ? next.x : 1.0;
  }

  void enter_stretch(double x) {
    ++stretch_;
    const bool contact = sticking_ && !stretch_->drive.lifted();
    if (in_contact_ && contact && state_.sticking) {
      sticking_->change_drive(since_base(x), stretch_->drive);
      mark_base(x);
    }
    if (in_contact_ && !contact) lift(x);
    if (!in_contact_ && contact) touch_down(x);
    in_contact_ = contact;
  }

  void lift(double x) {
    if (state_.sticking) {
      law().set_rise(sticking_->rise(since_base(x)));
      sticking_->detach(since_base(x), state_.modes);
      state_.sticking = false;
      if (loop_.witness != nullptr) loop_.witness->released();
    }
    mark_base(x);
  }

  // The bow comes back: it holds the string where both move alike, else the string slides.
  void touch_down(double x) {
    law().cool(since_base(x));
    const Motion motion = model_.observe(state_.modes, {.reactions = false});
    const BowDrive drive = stretch_->drive;
    const double slip = motion.velocity - drive.velocity;
    state_.sticking = slip == 0.0;
    if (state_.sticking) {
      sticking_->attach(drive, state_.modes, motion.displacement, 0.0, law().rise());
      mark_base(x);
      if (loop_.witness != nullptr) loop_.witness->attached(0.0);
    } else {
      sliding_.start(slip < 0.0 ? -1.0 : 1.0, std::abs(slip), drive.load);
    }
  }

  void grid_step(bool sampled) {
    double x = 0.0;
    int switches = 0;
    for (int parts = 0; x < 1.0; ++parts) {
      const double last = cut();
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
    if (loop_.witness != nullptr) loop_.witness->saw({.duration = (last - x) * loop_.grid_step});
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
    if (stretch_ != last_stretch_ && (stretch_ + 1)->start.step < step_ + Sticking::kBlock) {
      return 0;
    }
    const double tau = since_base(0.0);
    if (loop_.witness != nullptr) before_ = sticking_->state();
    const std::size_t held = sticking_->advance_block(tau, block_);
    if (loop_.witness != nullptr) show_held(tau, static_cast<double>(held) * loop_.grid_step);
    store(sample, held);
    counts_.steps += held;
    step_ += held;
    return held;
  }

  double stick(double x, double last, bool sampled) {
    const double remaining = (last - x) * loop_.grid_step;
    if (loop_.witness != nullptr) before_ = sticking_->state();
    const auto result = sticking_->advance(since_base(x), remaining, sampled && last == 1.0);
    if (loop_.witness != nullptr) show_held(since_base(x), result.time);
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
    const auto result = sliding_.advance(x, last, drive_at(x), state_.modes);
    if (loop_.witness != nullptr && result.position > x) show_slid(x);
    if (result.outcome == Outcome::kFailed) {
      fail(x,
           "the friction equation has no solution on any step: the force falls too steeply with "
           "the speed, or the state is not finite");
      return x;
    }
    if (result.outcome == Outcome::kAttached) attach(result.position);
    return result.position;
  }

  // What the string held from `tau` for `time` felt.
  void show_held(double tau, double time) {
    const double least = 1e-15 * time;
    for (double from = 0.0; time - from > least;) {
      const auto piece = sticking_->force_piece(before_, tau, from, time - from);
      loop_.witness->saw({.phase = ContactPhase::kSticking,
                          .duration = piece.time,
                          .force = piece.force,
                          .drive = sticking_->drive().from(tau + from)});
      from += piece.time;
    }
  }
  // What the step that slid from x felt.
  void show_slid(double x) {
    const auto step = sliding_.last_step();
    loop_.witness->saw({.phase = ContactPhase::kSliding,
                        .duration = step.length * loop_.grid_step,
                        .force = std::span(step.force).first(static_cast<std::size_t>(loop_.nodes)),
                        .drive = drive_at(x),
                        .side = sliding_.side(),
                        .rise = law().rise_powers()});
  }

  void attach(double x) {
    const double y = model_.observe(state_.modes, {.reactions = false}).displacement;
    const BowDrive drive = drive_at(x);
    const bool continuous = loop_.attach == AttachRule::kContinuous;
    const double force = -sliding_.side() * law().at(0.0, drive.load).friction;
    const double elongation = continuous ? -force / loop_.contact.stiffness : 0.0;
    sticking_->attach(drive, state_.modes, y, elongation, law().rise());
    if (loop_.witness != nullptr) loop_.witness->attached(elongation);
    mark_base(x);
    list_switch(x, y, true);
    state_.sticking = true;
    ++counts_.attachments;
  }

  // `limit`: the sign of the force that adherence could not carry.
  void release(double x, int limit) {
    sticking_->detach(since_base(x), state_.modes);
    law().set_rise(sticking_->rise(since_base(x)));
    if (loop_.witness != nullptr) loop_.witness->released();
    const Motion motion = model_.observe(state_.modes, {.reactions = false});
    const double v = motion.velocity;
    list_switch(x, motion.displacement, false);
    const BowDrive drive = drive_at(x);
    const double slip = v - drive.velocity;
    const double against_force = -limit;
    const bool at_rest = std::abs(slip) <= kAtRest * (std::abs(v) + std::abs(drive.velocity));
    const double side = at_rest ? against_force : slip < 0.0 ? -1.0 : 1.0;
    if (side != against_force) ++counts_.wrong_sign_releases;
    sliding_.start(side, at_rest ? 0.0 : std::abs(slip), drive.load);
    state_.sticking = false;
    ++counts_.releases;
  }

  void list_switch(double x, double displacement, bool attaches) {
    const double time = (static_cast<double>(step_) + x) * loop_.grid_step;
    loop_.switches.add({time, displacement, attaches});
  }

  Friction& law() { return sliding_.friction(); }

  // τ = 0 of adherence, and of a bow in the air.
  void mark_base(double x) { base_ = {step_, x}; }
  double since_base(double x) const { return since(base_, x); }

  void fail(double x, std::string reason) {
    counts_.failure = std::move(reason);
    counts_.failed_at = (static_cast<double>(step_) + x) * loop_.grid_step;
  }

  void store(std::size_t sample) {
    Motion motion;
    if (state_.sticking && in_contact_) {
      motion = sticking_->observe(since_base(0.0));
    } else {
      motion = model_.observe(state_.modes, wanted_);
      if (in_contact_) motion.force = sliding_.force();
    }
    if (!std::isfinite(motion.velocity) || !std::isfinite(motion.force)) {
      return fail(0.0, "the motion is not a finite number");
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

  void store(std::size_t sample, std::size_t count) {
    const auto copy = [&](const Sticking::Block::Row& row, double* to) {
      if (to == nullptr) return;
      if (count == Sticking::kBlock) {  // known to the compiler: no call
        std::copy_n(row.begin(), Sticking::kBlock, to + sample);
      } else {
        std::copy_n(row.begin(), count, to + sample);
      }
    };
    const SampleTargets& to = loop_.targets;
    copy(block_.displacement, to.displacement);
    copy(block_.velocity, to.velocity);
    copy(block_.force, to.force);
    copy(block_.left, to.left_reaction);
    copy(block_.right, to.right_reaction);
  }

  const EventLoop& loop_;
  EventState& state_;
  BowPath path_;
  const BowPath::Stretch* stretch_;  // the running one
  const BowPath::Stretch* last_stretch_;
  MotionRequest wanted_;
  SlidingModel model_;
  Sliding<Friction> sliding_;
  std::optional<Sticking> sticking_;
  bool in_contact_ = false;
  EventCounts counts_;
  std::uint64_t step_ = 0;
  GridPoint base_;
  Sticking::Block block_;  // the samples of a held block
  PlanarVector before_;    // what the held string was when it moved on, for the witness
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
  const LobattoRule rule = lobatto_rule(loop.nodes);
  const auto run = [&](auto friction) {
    return Run<decltype(friction)>(loop, friction, rule, modes, state).run();
  };
  if (loop.thermal) return run(ThermalFriction(*loop.thermal, rule, modes.effective_mass()));
  return std::visit(
      [&](const auto& law) { return run(CurveFriction(law, rule, modes.effective_mass())); },
      loop.law);
}

}  // namespace modcal::event
