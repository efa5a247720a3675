#include "libsim/dynamics/event/modal_event.hpp"

#include "libsim/base/words.hpp"

namespace modcal {

namespace {

// Velocity and force at the knots of both.
std::vector<event::BowKnot> knots_of(const BowMotion& bow) {
  std::vector<double> times = bow.velocity.times();
  const std::vector<double>& others = bow.normal_force.times();
  times.insert(times.end(), others.begin(), others.end());
  if (times.empty()) times.push_back(0.0);  // steady
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  std::vector<event::BowKnot> knots;
  for (const double t : times) knots.push_back({t, bow.velocity.at(t), bow.normal_force.at(t)});
  return knots;
}

constexpr std::array<std::string_view, 2> kAttachRules = {"literal", "continuous"};

event::AttachRule attach_rule_of(const std::string& name) {
  return enum_of<event::AttachRule>(kAttachRules, "attachment rule", name);
}

}  // namespace

void ModalEvent::Options::visit(OptionVisitor& visitor) {
  visitor("nodes", "Lobatto nodes of a sliding step: order 2(nodes - 1)",
          {.range = Range::closed(2, 5)}, nodes);
  visitor("max_step",
          "longest step; the next smaller one that divides the sampling period "
          "is taken",
          {.unit = "s", .range = Range::positive(), .word = "sampling_period"}, max_step);
  visitor("slope_number",
          "largest fall of the friction force with the speed, times the step, "
          "over the effective mass, of a sliding step",
          {.range = Range::positive()}, slope_number);
  visitor("tail_ratio",
          "highest power of the friction force in a sliding step, times the "
          "step, over effective mass and speed, at most this to the power "
          "nodes - 1; smaller ones halve more steps",
          {.range = Range::positive()}, tail_ratio);
  visitor("attach",
          "adherence spring at attachment: literal (unstretched: the force starts "
          "at 0) or continuous (the force goes on from the sliding limit)",
          {.choices = choices_of(kAttachRules)}, attach);
}

ModalEvent::ModalEvent(const Options& options) : options_(options) {
  MODCAL_REQUIRE(options.nodes >= 2 && options.nodes <= 5,
                 "{} collocation nodes: there are rules of 2 to 5", options.nodes);
  MODCAL_REQUIRE(options.slope_number > 0.0 && options.slope_number <= 1.0,
                 "slope number {:g} must be in (0, 1]: above 1 the friction equation of a step may "
                 "have several solutions",
                 options.slope_number);
  MODCAL_REQUIRE(options.tail_ratio > 0.0 && std::isfinite(options.tail_ratio),
                 "tail ratio {:g} must be > 0", options.tail_ratio);
  attach_rule_of(options.attach);
}

std::vector<SceneRefusal> ModalEvent::unsupported(const Scene& scene) const {
  std::vector<SceneRefusal> refusals;
  if (scene.bow.points > 1) {
    refusals.push_back(
        {"bow.points",
         fmt::format("{} contact points over {:g} m: modal_event locates the switches of one "
                     "contact point; use modal_exact or newmark_explicit, or one point",
                     scene.bow.points, scene.bow.width)});
  }
  if (std::holds_alternative<BristleFriction>(scene.friction.make()->stateful())) {
    refusals.push_back(
        {"friction",
         fmt::format("\"{}\" friction deflects bristles and never sticks, but modal_event goes "
                     "from one switch between sticking and sliding to the next; use modal_exact "
                     "or newmark_explicit, or a law with an adherence",
                     scene.friction.selected())});
  }
  return refusals;
}

Simulation ModalEvent::simulate_watched(const Scene& scene, double sample_rate,
                                        const OutputRequest& outputs, const event::Watch& watch,
                                        const StopToken& stop) const {
  ModalEvent watched = *this;
  watched.watch_ = &watch;
  return watched.simulate(scene, sample_rate, outputs, stop);
}

Simulation ModalEvent::run(const Scene& scene, double sample_rate, const OutputRequest& outputs,
                           const StopToken& stop) const {
  const double wanted = std::isnan(options_.max_step) ? 1.0 / sample_rate : options_.max_step;
  const StepPlan plan = plan_steps(wanted, sample_rate);
  const std::size_t count = sample_count(scene.duration, sample_rate);
  const BowMotion bow = bow_motion(scene.bow, scene.duration);
  const ContactModes modes = scene_modes(scene);
  const auto friction = scene.friction.make();
  const StatefulLaw stateful = friction->stateful();
  const auto* thermal = std::get_if<ThermalSliding>(&stateful);
  // Under a gesture law and limit are those of 1 N, and the load is the normal force in N; the
  // heat of a contact needs that force at all times.
  const bool scaled = thermal != nullptr || !bow.is_steady();
  const double force = scaled ? 1.0 : bow.normal_force.at(0.0);

  Simulation result = empty_simulation(count, sample_rate, outputs);
  ContactParameters contact = contact_parameters(bow, *friction, modes.effective_mass());
  contact.static_limit = friction->static_limit(force);
  event::EventState state = event::initial_state(modes, bow.velocity.at(0.0));
  if (thermal != nullptr) state.rise = thermal->rise;
  event::EventLoop loop{.contact = contact,
                        .law = thermal != nullptr ? SlidingLaw{} : friction->sliding(force),
                        .thermal = thermal != nullptr ? std::optional(*thermal) : std::nullopt,
                        .bow = scaled ? knots_of(bow) : std::vector<event::BowKnot>{},
                        .attach = attach_rule_of(options_.attach),
                        .nodes = static_cast<int>(options_.nodes),
                        .slope_number = options_.slope_number,
                        .tail_ratio = options_.tail_ratio,
                        .grid_step = plan.time_step,
                        .steps_per_sample = plan.steps_per_sample,
                        .samples = count,
                        .targets = targets_of(result),
                        .switches = {&result.switches, outputs.switches_from},
                        .stop = stop};
  if (watch_ != nullptr) loop.observer = watch_->begin(loop, modes, state);
  const event::EventCounts counts = event::run_event_loop(loop, modes, state);
  if (watch_ != nullptr && !counts.failure) watch_->end(state);

  if (counts.failure) {
    result.diverge(counts.failed_at, *counts.failure);
  }
  result.time_step = plan.time_step;
  result.steps = counts.steps;
  result.attachments = counts.attachments;
  result.releases = counts.releases;
  result.refined_steps = counts.refined_steps;
  result.modes_moved = modes.size();
  return result;
}

}  // namespace modcal
