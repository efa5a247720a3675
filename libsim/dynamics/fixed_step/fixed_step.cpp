#include "libsim/dynamics/fixed_step/fixed_step.hpp"

#include <cmath>

#include "libsim/base/error.hpp"
#include "libsim/dynamics/fixed_step/contact_rule.hpp"
#include "libsim/dynamics/fixed_step/explicit_stability.hpp"
#include "libsim/dynamics/fixed_step/line_step.hpp"
#include "libsim/dynamics/fixed_step/scene_setup.hpp"

namespace modcal {
namespace {

double steepest_fall(const SlidingLaw& law) {
  return std::visit([](const auto& l) { return l.steepest_fall(); }, law);
}

// One step with the force solved for needs a single solution of v = v_free + b F(v).
void require_unique_sliding(const SlidingLaw& law, double response, double time_step) {
  const double fall = steepest_fall(law);
  MODCAL_REQUIRE(
      fall * response < 1.0,
      "time step {:g} s is too long for this friction law: its force falls by {:g} N per "
      "m/s, which needs a step below about {:g} s",
      time_step, fall, time_step / (fall * response));
}

void store_first(Signal& signal, double value) {
  if (!signal.samples.empty()) signal.samples[0] = value;
}

struct ContactMotion {
  double displacement = 0.0, velocity = 0.0, left = 0.0, right = 0.0;
};

ContactMotion initial_motion(const ContactModes& modes) {
  ContactMotion motion;
  for (std::size_t n = 0; n < modes.size(); ++n) {
    const std::complex<double> z = modes.initial[n];
    motion.displacement += modes.compliance[n] * z.imag();
    motion.velocity += z.real() - modes.quadrature[n] * z.imag();
    motion.left += modes.left_gain[n] * z.imag();
    motion.right += modes.right_gain[n] * z.imag();
  }
  return motion;
}

double initial_force(const StepLoop& loop) {
  return std::visit(
      [&loop](const auto& law) {
        return ContactRule(loop.contact, law, loop.time_step, loop.initial_displacement,
                           loop.initial_velocity)
            .initial_force();
      },
      loop.law);
}

void store_initial(Simulation& result, const ContactMotion& motion, double force) {
  store_first(result.displacement, motion.displacement);
  store_first(result.velocity, motion.velocity);
  store_first(result.force, force);
  store_first(result.left_reaction, motion.left);
  store_first(result.right_reaction, motion.right);
}

// Whether one point, a steady bow and a law of the sliding speed are all that there is.
bool is_plain(const Scene& scene, const BowMotion& bow, const FrictionLaw& friction) {
  return scene.bow.points == 1 && scene.bow.width == 0.0 && bow.is_steady() &&
         !friction.has_state();
}

}  // namespace

SchemeWeights scheme_weights(std::span<const std::complex<double>> poles, double time_step,
                             WeightsOfPole weights) {
  SchemeWeights result;
  for (const std::complex<double> pole : poles) {
    const ModeWeights mode = weights(pole, time_step);
    result.propagate.push_back(mode.propagate);
    result.older.push_back(mode.older);
    result.newer.push_back(mode.newer);
  }
  return result;
}

void FixedStepOptions::visit(OptionVisitor& visitor) {
  visitor.number({.key = "time_step",
                  .meaning = "largest time step; the next smaller one that divides the sampling "
                             "period is taken",
                  .unit = "s",
                  .range = Range::positive()},
                 time_step);
}

Simulation simulate_fixed_step(const Scene& scene, double sample_rate, const OutputRequest& outputs,
                               const StopToken& stop, double wanted_time_step, ForceTiming timing,
                               WeightsOfPole weights_of_pole) {
  const BowMotion bow = bow_motion(scene.bow, scene.duration);
  const auto friction = scene.friction.make();
  const auto general = [&] {
    return simulate_line(scene, sample_rate, outputs, stop, wanted_time_step, timing,
                         weights_of_pole);
  };
  if (!is_plain(scene, bow, *friction)) return general();
  const StepPlan plan = plan_steps(wanted_time_step, sample_rate);
  const std::size_t count = sample_count(scene.duration, sample_rate);
  const ContactModes modes = scene_modes(scene);
  const SchemeWeights weights = scheme_weights(modes.pole, plan.time_step, weights_of_pole);
  if (!are_separable(weights)) return general();
  const ContactMotion motion = initial_motion(modes);

  StepLoop loop{.timing = timing,
                .time_step = plan.time_step,
                .steps_per_sample = plan.steps_per_sample,
                .samples = count,
                .contact = contact_parameters(bow, *friction, modes.effective_mass()),
                .law = friction->sliding(bow.normal_force.at(0.0)),
                .initial_displacement = motion.displacement,
                .initial_velocity = motion.velocity,
                .targets = {},
                .stop = stop};
  const double first_force = initial_force(loop);
  // The explicit scheme has no force before t = 0; the implicit one starts with that of t = 0.
  StepCoefficients coefficients =
      make_step_coefficients(modes, weights, timing == ForceTiming::kImplicit ? first_force : 0.0);
  if (timing == ForceTiming::kImplicit) {
    require_unique_sliding(loop.law, coefficients.direct_response.velocity, plan.time_step);
  } else if (loop.contact.static_limit > 0.0) {
    require_stable_contact({.stiffness = loop.contact.stiffness,
                            .damping = loop.contact.damping,
                            .fall = steepest_fall(loop.law),
                            .response = coefficients.direct_response.velocity},
                           plan.time_step);
  }

  Simulation result = empty_simulation(count, sample_rate, outputs);
  store_initial(result, motion, first_force);
  loop.targets = targets_of(result);
  loop.switches = {&result.switches, outputs.switches_from};
  const LoopCounts counts = run_step_loop(loop, coefficients);

  if (counts.first_bad_sample < count) {
    result = empty_simulation(0, sample_rate, {});
    result.diverged_at = static_cast<double>(counts.first_bad_sample) / sample_rate;
    result.explanation = "the motion is not a finite number";
  }
  result.time_step = plan.time_step;
  result.steps = (count - 1) * plan.steps_per_sample;
  result.attachments = counts.attachments;
  result.releases = counts.releases;
  result.modes_moved = modes.size();
  return result;
}

}  // namespace modcal
