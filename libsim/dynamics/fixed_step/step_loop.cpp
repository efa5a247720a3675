#include "libsim/dynamics/fixed_step/step_loop.hpp"

#include "libsim/dynamics/fixed_step/contact_rule.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libsim/dynamics/fixed_step/step_loop.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "libsim/dynamics/fixed_step/stepped_modes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::HWY_NAMESPACE {

// The string a step ahead of the contact: `base` is the sum over P of the coming step without the
// force `pending`, which the modes have not taken up yet.
template <typename Modes>
struct LeadingString {
  Modes modes;
  double base = 0.0, pending = 0.0;

  // The sum that was asked for with the last step.
  HWY_INLINE double Leading(const SumWeights& weights) const {
    return base + weights.kick * pending;
  }
  // Any sum, at the cost of a pass over the modes.
  HWY_INLINE double Sum(const SumWeights& weights) const {
    return modes.Sum(weights) + weights.kick * pending;
  }
  HWY_INLINE void Advance(double force, const SumWeights& weights) {
    base = modes.Advance(pending, weights);
    pending = force;
  }
};

// The contact forces of the two steps before the running one.
struct LastForces {
  double newest = 0.0, older = 0.0;

  // The force that S of the running step takes up: the scheme that solves for its force has used
  // the newest one already.
  template <ForceTiming kTiming>
  HWY_INLINE double Taken() const {
    return kTiming == ForceTiming::kImplicit ? newest : older;
  }
  HWY_INLINE void Push(double force) {
    older = newest;
    newest = force;
  }
};

struct Weights {
  explicit Weights(const StepCoefficients& c)
      : velocity(c.velocity), displacement(c.displacement), held(c.held) {}
  SumWeights velocity, displacement, held;
  HWY_INLINE const SumWeights& For(bool sticking) const { return sticking ? held : velocity; }
};

// Goes on sticking for `steps` steps at most; returns how many.
template <ForceTiming kTiming, typename Modes, typename Held>
HWY_INLINE std::size_t StickOn(const Held& held, const SumWeights& weights, std::size_t steps,
                               LeadingString<Modes>& string, LastForces& forces) {
  for (std::size_t j = 0; j < steps; ++j) {
    const double bow = held.bow + held.bow_per_step * static_cast<double>(j);
    double rest = bow - string.Leading(weights);
    if constexpr (kTiming == ForceTiming::kPreviousStep) rest += held.older * forces.older;
    const double force = rest + held.newest * forces.newest;
    if (!(std::abs(force) <= held.limit)) return j;
    string.Advance(forces.Taken<kTiming>(), weights);
    forces.Push(force);
  }
  return steps;
}

// Goes on sliding for `steps` steps at most; returns how many.
template <ForceTiming kTiming, typename Modes, typename Rule>
HWY_INLINE std::size_t SlideOn(const Rule& rule, const SumWeights& weights, std::size_t steps,
                               LeadingString<Modes>& string, LastForces& forces) {
  for (std::size_t j = 0; j < steps; ++j) {
    const double v0 = string.Leading(weights);
    double force = 0.0;
    bool going_on = false;
    if constexpr (kTiming == ForceTiming::kImplicit) {
      going_on = rule.implicit_slides_on(v0, forces.newest, force);
    } else {
      going_on = rule.explicit_slides_on(v0, forces.newest, forces.older, force);
    }
    if (!going_on) return j;
    string.Advance(forces.Taken<kTiming>(), weights);
    forces.Push(force);
  }
  return steps;
}

// Goes on as before; returns for how many of the steps from `step` + 1 on.
template <ForceTiming kTiming, typename Modes, typename Rule>
HWY_INLINE std::size_t GoOn(const Rule& rule, const Weights& weights, std::uint64_t step,
                            std::size_t steps, LeadingString<Modes>& string, LastForces& forces) {
  if (!rule.sticking()) return SlideOn<kTiming>(rule, weights.velocity, steps, string, forces);
  const auto held = kTiming == ForceTiming::kImplicit ? rule.implicit_held(step + 1)
                                                      : rule.explicit_held(step + 1);
  return StickOn<kTiming>(held, weights.held, steps, string, forces);
}

// One step whatever happens in it.
template <ForceTiming kTiming, typename Modes, typename Rule>
HWY_INLINE void StepAcross(Rule& rule, const StepCoefficients& c, const Weights& weights,
                           std::uint64_t step, LeadingString<Modes>& string, LastForces& forces) {
  const double taken = forces.Taken<kTiming>(), newest = forces.newest;
  const double v0 = string.Sum(weights.velocity), y0 = string.Sum(weights.displacement);
  double force = 0.0;
  string.modes.Store();
  if constexpr (kTiming == ForceTiming::kImplicit) {
    force = rule.implicit_force(v0, y0, taken, step);
  } else {
    const double v = v0 + c.deferred_response.velocity * taken;
    const double y = y0 + c.deferred_response.displacement * taken;
    force = rule.explicit_force(v + c.direct_response.velocity * newest,
                                y + c.direct_response.displacement * newest, step);
  }
  string.modes.Load();
  string.Advance(taken, weights.For(rule.sticking()));
  forces.Push(force);
}

// The step that is sampled, without the force that drives it: S where it is asked for, and the
// velocity, which tells whether the motion is finite.
template <ForceTiming kTiming, typename Modes>
HWY_INLINE MotionSample Observe(const SampleTargets& to, const StepCoefficients& c,
                                const LeadingString<Modes>& string, const LastForces& forces) {
  const double taken = forces.Taken<kTiming>();
  const auto sum = [&](bool wanted, const ModeSum& of, double response) HWY_ATTR {
    return wanted ? string.Sum(SumWeights(of)) + response * taken : 0.0;
  };
  const MotionSample& response = c.deferred_response;
  return {.displacement = sum(to.displacement, c.displacement, response.displacement),
          .velocity = sum(true, c.velocity, response.velocity),
          .left = sum(to.left_reaction, c.left, response.left),
          .right = sum(to.right_reaction, c.right, response.right)};
}

// Stores the sample; false where it is not finite.
HWY_INLINE bool StoreSample(const SampleTargets& to, std::size_t sample, const StepCoefficients& c,
                            const MotionSample& observed, double driving, double force) {
  const MotionSample& direct = c.direct_response;
  const double velocity = observed.velocity + direct.velocity * driving;
  to.write(sample, {.displacement = observed.displacement + direct.displacement * driving,
                    .velocity = velocity,
                    .force = force,
                    .left = observed.left + direct.left * driving,
                    .right = observed.right + direct.right * driving});
  return std::isfinite(velocity) && std::isfinite(force);
}

template <ForceTiming kTiming, typename Modes, typename Law>
LoopCounts Loop(const FixedStepRun& run, ContactRule<Law>& rule, StepCoefficients& c) {
  const Weights weights(c);
  LastForces forces{.newest = rule.initial_force()};
  LeadingString<Modes> string{Modes(c)};
  string.base = string.modes.Sum(weights.For(rule.sticking()));
  std::uint64_t step = 0;
  LoopCounts counts;
  for (std::size_t sample = 1; sample < run.samples && !run.stop.requested(); ++sample) {
    run.stop.tell(sample, run.samples);
    MotionSample observed;
    for (std::size_t left = run.steps_per_sample; left > 0;) {
      if (left == 1) observed = Observe<kTiming>(run.targets, c, string, forces);
      const std::size_t wanted = left == 1 ? 1 : left - 1;
      const std::size_t gone = GoOn<kTiming>(rule, weights, step, wanted, string, forces);
      step += gone;
      left -= gone;
      if (gone == wanted) continue;
      StepAcross<kTiming>(rule, c, weights, ++step, string, forces);
      --left;
    }
    const double driving = kTiming == ForceTiming::kImplicit ? forces.newest : forces.older;
    if (!StoreSample(run.targets, sample, c, observed, driving, forces.newest)) {
      counts.first_bad_sample = sample;
      break;
    }
  }
  counts.attachments = rule.attachments();
  counts.releases = rule.releases();
  return counts;
}

template <typename Modes, typename Law>
LoopCounts LoopOf(const FixedStepRun& run, ContactRule<Law>& rule, StepCoefficients& c) {
  return run.timing == ForceTiming::kImplicit
             ? Loop<ForceTiming::kImplicit, Modes>(run, rule, c)
             : Loop<ForceTiming::kPreviousStep, Modes>(run, rule, c);
}

// The state in registers where it is kVectors vectors or less, else in memory.
template <std::size_t kVectors, typename Law>
LoopCounts LoopOfLaw(const FixedStepRun& run, ContactRule<Law>& rule, StepCoefficients& c) {
  if constexpr (kVectors > 0) {
    if (c.first.size() != kVectors * kVectorPadding) return LoopOfLaw<kVectors - 1>(run, rule, c);
    return LoopOf<ResidentModes<kVectors>>(run, rule, c);
  } else {
    return LoopOf<StreamedModes>(run, rule, c);
  }
}

constexpr std::size_t kMostVectors = HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL ? 8 : 0;

LoopCounts RunStepLoop(const FixedStepRun& run, const SteadyContact& contact, StepCoefficients& c) {
  return std::visit(
      [&](const auto& law) {
        auto rule = make_rule(run, contact, law, c);
        return LoopOfLaw<kMostVectors>(run, rule, c);
      },
      contact.law);
}

}  // namespace modcal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal {

HWY_EXPORT(RunStepLoop);

LoopCounts run_step_loop(const FixedStepRun& run, const SteadyContact& contact,
                         StepCoefficients& coefficients) {
  return HWY_DYNAMIC_DISPATCH(RunStepLoop)(run, contact, coefficients);
}

double initial_force(const SteadyContact& contact) {
  return std::visit(
      [&contact](const auto& law) {
        return ContactRule(contact.parameters, law, 0.0, contact.initial_displacement,
                           contact.initial_velocity)
            .initial_force();
      },
      contact.law);
}

}  // namespace modcal
#endif
