#include "libinverse/observer/observer_kernel.hpp"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "libinverse/observer/observer_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "libinverse/observer/observer_modes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace modcal::observer::HWY_NAMESPACE {

template <std::size_t kVectors>
class Observer {
 public:
  Observer(const StringTables& string, const ContactLaw& contact, ObserverState& state)
      : string_(string),
        law_(contact.sliding),
        contact_(contact),
        state_(state),
        run_{Modes<kVectors>(string, state.modes), {}, state.force, state.elongation},
        side_(state.side),
        sticking_(state.sticking) {
    law_.temperature = state.temperature;
  }

  void Run(const GainTable& gain, const ObserverSignals& signals, std::size_t first,
           std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      scale_ = signals.force_scale[k];
      bow_ = signals.bow_velocity[k];
      limit_ = scale_ * law_.at_rest();
      Correct(gain, signals, k);
      AdvanceSample();
      if (signals.mean_force) {
        signals.mean_force[k] = impulse_ / static_cast<double>(string_.substeps.coarse);
      }
    }
    run_.modes.Store();
    state_.elongation = run_.elongation;
    state_.force = run_.force;
    state_.side = side_;
    state_.sticking = sticking_;
    state_.temperature = law_.temperature;
  }

 private:
  // What the step loop holds in registers.
  struct Running {
    Modes<kVectors> modes;
    Motion now;
    double force, elongation;
  };

  void Correct(const GainTable& gain, const ObserverSignals& signals, std::size_t k) {
    double innovation[2];
    for (std::size_t r = 0; r < 2; ++r) {
      innovation[r] =
          signals.reaction[r][k] - contact_.offset[r] - run_.modes.Reaction(string_.gain[r]);
    }
    run_.now = run_.modes.Add(gain[0], innovation[0], gain[1], innovation[1]);
    FindForceAgain();
    for (std::size_t r = 0; r < 2; ++r) {
      if (signals.innovation[r]) signals.innovation[r][k] = innovation[r];
    }
    if (signals.force) signals.force[k] = run_.force;
    if (signals.velocity) signals.velocity[k] = run_.now.velocity;
    if (signals.displacement) signals.displacement[k] = run_.now.displacement;
  }

  // The force that belongs to the corrected state.
  void FindForceAgain() {
    const double slip = run_.now.velocity - bow_;
    if (sticking_) {
      run_.force = -contact_.stiffness * run_.elongation - contact_.damping * slip;
      if (std::abs(run_.force) <= limit_) return;
      sticking_ = false;
      side_ = run_.force > 0.0 ? -1.0 : 1.0;
    } else if (side_ * slip <= 0.0) {
      run_.force = -contact_.damping * slip;
      if (std::abs(run_.force) <= limit_) {
        sticking_ = true;
        run_.elongation = 0.0;
        return;
      }
      side_ = -side_;
    }
    run_.force = -side_ * scale_ * law_.at(std::max(0.0, side_ * slip)).force;
  }

  void AdvanceSample() {
    const StepTable& t = string_.coarse;
    const double travel = bow_ * t.step;
    const MotionSample direct = t.newer_response, deferred = t.deferred_response;
    const double stiffness = contact_.stiffness, damping = contact_.damping;
    const double held = 1.0 / (1.0 + stiffness * direct.displacement + damping * direct.velocity);
    double least = direct.velocity * limit_;
    Running run = run_;  // a copy that no call can reach stays in registers
    impulse_ = 0.0;      // in steps: the sum of the steps' mean forces
    // P = r (Z − d f): what the next step needs of the modes does not wait for its force.
    Motion sums = run.modes.AddThenTurn(t.propagate, t.newer, -run.force);
    for (std::size_t left = string_.substeps.coarse; left > 0; --left) {
      const Motion free = {sums.velocity + deferred.velocity * run.force,
                           sums.displacement + deferred.displacement * run.force};
      const double older = run.force;
      sums = run.modes.AddThenTurn(t.propagate, t.deferred, older);
      const double slip = free.velocity - bow_;
      bool switches;
      if (sticking_) {
        const double stretch = run.elongation + free.displacement - run.now.displacement - travel;
        run.force = -(stiffness * stretch + damping * slip) * held;
        switches = !(std::abs(run.force) <= limit_);
      } else {
        switches = !(side_ * slip > least);
        if (!switches) {
          const double speed = side_ * (run.now.velocity - bow_);
          run.force = -side_ * SlidingForce(law_, scale_, direct.velocity, side_ * slip, speed);
        }
      }
      if (switches) {
        // P/r is the state without the newest force; a step back, and again in fine ones.
        run.modes.TurnThenAdd(t.undo, t.older, -older);
        run.modes.TurnThenAdd(t.undo, t.older, 0.0);
        run.force = older;
        run_ = run;
        CrossSwitch();
        if (left == 1) return;
        run = run_;
        least = direct.velocity * limit_;
        sums = run.modes.AddThenTurn(t.propagate, t.newer, -run.force);
        continue;
      }
      impulse_ += 0.5 * (older + run.force);
      const Motion next = {free.velocity + direct.velocity * run.force,
                           free.displacement + direct.displacement * run.force};
      if (sticking_) run.elongation += next.displacement - run.now.displacement - travel;
      run.now = next;
      if (law_.thermal) {
        Warm(t.step, run.now.velocity, run.force);
        least = direct.velocity * limit_;
      }
    }
    run.modes.TurnThenAdd(t.undo, t.newer, run.force);
    run_ = run;
  }

  // One coarse step from the state Z in fine ones.
  HWY_NOINLINE void CrossSwitch() {
    const StepTable& t = string_.fine;
    const double a = t.older_response.velocity, b = t.newer_response.velocity;
    const double held =
        1.0 / (1.0 + contact_.stiffness * t.newer_response.displacement + contact_.damping * b);
    for (std::size_t i = 0; i < string_.substeps.fine; ++i) {
      const Motion free = run_.modes.TurnThenAdd(t.propagate, t.older, 0.0);
      double older = run_.force, force = 0.0, stretch = 0.0;
      const double slip = free.velocity + a * run_.force - bow_;
      bool held_throughout = sticking_, attaches = false;
      if (sticking_) {
        const double moved = free.displacement + t.older_response.displacement * run_.force -
                             run_.now.displacement - bow_ * t.step;
        force = -(contact_.stiffness * (run_.elongation + moved) + contact_.damping * slip) * held;
        if (!(std::abs(force) <= limit_)) {
          sticking_ = held_throughout = false;
          side_ = force > 0.0 ? -1.0 : 1.0;
          force = -side_ * FineSlidingForce(slip);
        }
      } else if (side_ * slip > b * limit_) {
        force = -side_ * FineSlidingForce(slip);
      } else {
        attaches = true;
      }
      if (attaches) {
        // Slip speed from u₀ ≥ 0 to u₁ ≤ 0: it vanishes at the share θ of the step, where the force
        // jumps. Its impulse is that of a ramp from 2θ f_old + (1 − 2θ) f.
        const double u0 = std::max(0.0, side_ * (run_.now.velocity - bow_));
        const double u1 = side_ * slip - b * limit_;
        const double theta = u0 - u1 > 0.0 ? u0 / (u0 - u1) : 0.0;
        const double stiff = 0.5 * (1.0 - theta) * t.step * contact_.stiffness + contact_.damping;
        const double start = free.velocity + 2.0 * theta * a * run_.force - bow_;
        const double response = b + (1.0 - 2.0 * theta) * a;
        force = -stiff * start / (1.0 + stiff * response);
        if (std::abs(force) <= limit_) {
          older = 2.0 * theta * run_.force + (1.0 - 2.0 * theta) * force;
          stretch = 0.5 * (1.0 - theta) * t.step * (start + response * force);
          sticking_ = true;
        } else {
          attaches = false;
          side_ = -side_;
          force = -side_ * FineSlidingForce(slip);
        }
      }
      const Motion now = run_.modes.Add(t.older, older, t.newer, force);
      impulse_ += 0.5 * (older + force) / static_cast<double>(string_.substeps.fine);
      if (held_throughout)
        run_.elongation += now.displacement - run_.now.displacement - bow_ * t.step;
      if (attaches) run_.elongation = stretch;
      run_.now = now;
      run_.force = force;
      if (law_.thermal) Warm(t.step, run_.now.velocity, run_.force);
    }
  }

  // The temperature after a step that ends with this velocity and force, and what the string sticks
  // up to from there.
  HWY_NOINLINE void Warm(double step, double velocity, double force) {
    const double speed = sticking_ ? 0.0 : std::max(0.0, side_ * (velocity - bow_));
    law_.warm(step, speed, std::abs(force));
    limit_ = scale_ * law_.at_rest();
  }

  // scale·g(u) at the root u ≥ 0 of u + b scale g(u) = w by Newton's iteration from the last speed.
  static HWY_NOINLINE double SlidingForce(const BlendedSliding& law, double scale, double response,
                                          double w, double last_speed) {
    if (law.thermal) return scale * law.at_rest();
    const double b = response * scale;
    if (!(w > b * law.at_rest())) return scale * law.at_rest();
    double u = std::max(0.0, last_speed);
    for (int iteration = 0; iteration < 20; ++iteration) {
      const BlendedSliding::Point at = law.at(u);
      const double change = (u + b * at.force - w) / std::max(0.05, 1.0 + b * at.slope);
      const double moved = std::max(0.0, u - change) - u;
      if (std::abs(moved) <= 1e-6 * (u + 1e-6)) return scale * (at.force + moved * at.slope);
      u += moved;
    }
    return scale * law.at(u).force;
  }
  double FineSlidingForce(double slip) const {
    return SlidingForce(law_, scale_, string_.fine.newer_response.velocity, side_ * slip,
                        side_ * (run_.now.velocity - bow_));
  }

  const StringTables& string_;
  BlendedSliding law_;
  const ContactLaw contact_;
  ObserverState& state_;
  Running run_;
  double side_;
  bool sticking_;
  double scale_ = 1.0, bow_ = 0.0, limit_ = 0.0;
  double impulse_ = 0.0;
};

template <std::size_t kVectors>
void RunWith(const StringTables& string, const ContactLaw& contact, const GainTable& gain,
             const ObserverSignals& signals, std::size_t first, std::size_t last,
             ObserverState& state) {
  Observer<kVectors>(string, contact, state).Run(gain, signals, first, last);
}

void RunObserver(const StringTables& string, const ContactLaw& contact, const GainTable& gain,
                 const ObserverSignals& signals, std::size_t first, std::size_t last,
                 ObserverState& state) {
  auto* run = RunWith<0>;
#if HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
  // 2 kVectors of the 32 registers hold the state.
  static constexpr decltype(run) kRuns[] = {RunWith<0>, RunWith<1>, RunWith<2>, RunWith<3>,
                                            RunWith<4>, RunWith<5>, RunWith<6>, RunWith<7>};
  const std::size_t vectors = string.size() / kVectorPadding;
  if (vectors < std::size(kRuns)) run = kRuns[vectors];
#endif
  run(string, contact, gain, signals, first, last, state);
}

}  // namespace modcal::observer::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace modcal::observer {
HWY_EXPORT(RunObserver);

ObserverState ObserverState::at_rest(std::size_t size) {
  ObserverState state;
  state.modes = PlanarVector(size);
  return state;
}

void run_observer(const StringTables& string, const ContactLaw& contact, const GainTable& gain,
                  const ObserverSignals& signals, std::size_t first, std::size_t last,
                  ObserverState& state) {
  HWY_DYNAMIC_DISPATCH(RunObserver)(string, contact, gain, signals, first, last, state);
}

}  // namespace modcal::observer
#endif
