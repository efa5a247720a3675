#include "libsim/dynamics/fixed_step/line_step.hpp"

#include "libsim/base/error.hpp"
#include "libsim/dynamics/fixed_step/explicit_stability.hpp"
#include "libsim/dynamics/fixed_step/scene_setup.hpp"

namespace modcal {
namespace {

LineFriction friction_of(const FrictionLaw& law, double effective_mass) {
  const ContactParameters contact =
      contact_parameters({PiecewiseLinear(0.0), PiecewiseLinear(1.0)}, law, effective_mass);
  LineFriction friction{.coefficient = {},
                        .stateful = law.stateful(),
                        .stiffness = contact.stiffness,
                        .damping = contact.damping};
  if (!law.has_state()) friction.coefficient = law.sliding(1.0);
  return friction;
}

// Throws InvalidInput where the scheme cannot take the step.
void require_step(const LineLoop& loop, double response) {
  if (loop.timing == ForceTiming::kImplicit) {
    const double slope_number = steepest_fall(loop) * response;
    MODCAL_REQUIRE(slope_number < 1.0,
                   "time step {:g} s is too long for this friction law: its fall with the speed "
                   "needs a step below about {:g} s",
                   loop.time_step, loop.time_step / slope_number);
  } else if (loop.bow.normal_force.highest() > 0.0) {
    require_stable_contact({.stiffness = loop.friction.stiffness,
                            .damping = loop.friction.damping,
                            .fall = steepest_fall(loop),
                            .response = response},
                           loop.time_step);
  }
}

}  // namespace

Simulation simulate_line(const Scene& scene, double sample_rate, const OutputRequest& outputs,
                         const StopToken& stop, double wanted_time_step, ForceTiming timing,
                         WeightsOfPole weights_of_pole, std::vector<PointMotion>* points) {
  const StepPlan plan = plan_steps(wanted_time_step, sample_rate);
  const std::size_t count = sample_count(scene.duration, sample_rate);
  const LineModes modes = scene_line_modes(scene);
  const auto friction = scene.friction.make();
  const SchemeWeights weights = scheme_weights(modes.pole, plan.time_step, weights_of_pole);
  LineLoop loop{.timing = timing,
                .time_step = plan.time_step,
                .steps_per_sample = plan.steps_per_sample,
                .samples = count,
                .bow = bow_motion(scene.bow, scene.duration),
                .friction = friction_of(*friction, modes.effective_mass()),
                .targets = {},
                .switches = {},
                .stop = stop};
  require_step(loop, contact_response(modes, weights));
  Simulation result = empty_simulation(count, sample_rate, outputs);
  loop.targets = targets_of(result);
  if (points != nullptr) {
    points->assign(modes.points(), PointMotion(count));
    for (PointMotion& point : *points) {
      loop.point_targets.push_back({.displacement = point.displacement.data(),
                                    .velocity = point.velocity.data(),
                                    .force = point.force.data()});
    }
  }
  loop.switches = {&result.switches, outputs.switches_from};
  const LineCounts counts = run_line_loop(loop, modes, weights);
  if (counts.first_bad_sample < count) {
    result = empty_simulation(0, sample_rate, {});
    result.diverged_at = static_cast<double>(counts.first_bad_sample) / sample_rate;
    result.explanation = counts.settled ? "the motion is not a finite number"
                                        : "the forces of the contact points do not settle within a "
                                          "step: use a smaller time step";
  }
  result.time_step = plan.time_step;
  result.steps = (count - 1) * plan.steps_per_sample;
  result.attachments = counts.attachments;
  result.releases = counts.releases;
  result.modes_moved = modes.size();
  return result;
}

}  // namespace modcal
