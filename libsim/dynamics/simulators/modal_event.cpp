#include "libsim/dynamics/simulators/modal_event.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "libsim/base/error.hpp"
#include "libsim/dynamics/event/event_loop.hpp"
#include "libsim/dynamics/simulators/scene_setup.hpp"

namespace modcal {

namespace {

// Velocity and force at the knots of both.
std::vector<event::BowKnot> knots_of(const BowMotion& bow) {
  std::vector<double> times = bow.velocity.times();
  const std::vector<double>& others = bow.normal_force.times();
  times.insert(times.end(), others.begin(), others.end());
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  std::vector<event::BowKnot> knots;
  for (const double t : times) knots.push_back({t, bow.velocity.at(t), bow.normal_force.at(t)});
  return knots;
}

}  // namespace

void ModalEvent::Options::visit(OptionVisitor& visitor) {
  visitor.integer({.key = "nodes",
                   .meaning = "Lobatto nodes of a sliding step: order 2(nodes - 1)",
                   .range = Range::closed(2, 5)},
                  nodes);
  visitor.number({.key = "max_step",
                  .meaning = "longest step; the next smaller one that divides the sampling period "
                             "is taken",
                  .unit = "s",
                  .range = Range::positive(),
                  .word = "sampling_period"},
                 max_step);
  visitor.number({.key = "slope_number",
                  .meaning = "largest fall of the friction force with the speed, times the step, "
                             "over the effective mass, of a sliding step",
                  .unit = "1",
                  .range = Range::positive()},
                 slope_number);
  visitor.text({.key = "attach",
                .meaning = "adherence spring at attachment: literal (unstretched: the force starts "
                           "at 0) or continuous (the force goes on from the sliding limit)",
                .choices = {"literal", "continuous"}},
               attach);
}

ModalEvent::ModalEvent(const Options& options) : options_(options) {
  MODCAL_REQUIRE(options.nodes >= 2 && options.nodes <= 5,
                 "{} collocation nodes: there are rules of 2 to 5", options.nodes);
  MODCAL_REQUIRE(options.slope_number > 0.0 && options.slope_number <= 1.0,
                 "slope number {:g} must be in (0, 1]: above 1 the friction equation of a step may "
                 "have several solutions",
                 options.slope_number);
  MODCAL_REQUIRE(options.attach == "literal" || options.attach == "continuous",
                 "unknown attachment rule \"{}\": literal or continuous", options.attach);
}

Simulation ModalEvent::run(const Scene& scene, double sample_rate, const OutputRequest& outputs,
                           const StopToken& stop) const {
  const double wanted = std::isnan(options_.max_step) ? 1.0 / sample_rate : options_.max_step;
  const StepPlan plan = plan_steps(wanted, sample_rate);
  const std::size_t count = sample_count(scene.duration, sample_rate);
  const BowMotion bow = bow_motion(scene.bow, scene.duration);
  // Under a gesture law and limit are those of 1 N, and the load is the normal force in N.
  const double force = bow.is_steady() ? bow.normal_force.at(0.0) : 1.0;
  const ContactModes modes = scene_modes(scene);
  const auto friction = scene.friction.make();

  Simulation result = empty_simulation(count, sample_rate, outputs);
  ContactParameters contact = contact_parameters(bow, *friction, modes.effective_mass());
  contact.static_limit = friction->static_limit(force);
  const event::EventLoop loop{
      .contact = contact,
      .law = friction->sliding(force),
      .bow = bow.is_steady() ? std::vector<event::BowKnot>{} : knots_of(bow),
      .attach = options_.attach == "continuous" ? event::AttachRule::kContinuous
                                                : event::AttachRule::kLiteral,
      .nodes = static_cast<int>(options_.nodes),
      .slope_number = options_.slope_number,
      .grid_step = plan.time_step,
      .steps_per_sample = plan.steps_per_sample,
      .samples = count,
      .targets = targets_of(result),
      .switches = {&result.switches, outputs.switches_from},
      .stop = stop};
  event::EventState state = event::initial_state(modes, bow.velocity.at(0.0));
  const event::EventCounts counts = event::run_event_loop(loop, modes, state);

  if (counts.failure) {
    result = empty_simulation(0, sample_rate, {});
    result.diverged_at = counts.failed_at;
    result.explanation = *counts.failure;
  }
  result.time_step = plan.time_step;
  result.steps = counts.steps;
  result.attachments = counts.attachments;
  result.releases = counts.releases;
  result.modes_moved = modes.size();
  return result;
}

}  // namespace modcal
