#include "experiments/kinds/lint.hpp"
#include "experiments/kinds/section7/pluck_then_bow.hpp"

namespace modcal {

void PluckTestOptions::visit(OptionVisitor& visitor) {
  visit_pluck(visitor, start, duration, noise_level);
  visitor("identification", "how its modes are found", identification);
  visitor("damping_degree", "degree of the polynomial that extrapolates the damping ratios",
          {.range = Range::closed(0, 4)}, damping_degree);
}

void RefinementOptions::visit(OptionVisitor& visitor) {
  visitor("first_modes", "plucked modes that are refined before the first law is fitted",
          {.range = Range::closed(2, 1000)}, first_modes);
  visitor("law_modes",
          "modes that the first law is fitted to; those beyond first_modes as "
          "plucked",
          {.range = Range::closed(2, 1000)}, law_modes);
  visitor("objective", "what is minimized", objective);
  visitor("optimizer", "how it is minimized", optimizer);
  visitor("budget", "what each search may spend", budget);
  visitor("excitation_threshold",
          "modes with a smaller |phi_n(x_c)| get their frequency from the law",
          {.range = Range::closed(0.0, 1.0)}, excitation_threshold);
}

void ContactSearchOptions::visit(OptionVisitor& visitor) {
  visitor("start", "contact point as measured on the string",
          {.unit = "m", .range = Range::positive(), .required = true}, start);
  visitor("range", "how far the search reaches to either side",
          {.unit = "m", .range = Range::positive()}, range);
  visitor("points", "points of the curve that brackets the minimum",
          {.range = Range::closed(5, 100000)}, points);
  visitor("objective", "what is minimized", objective);
}

void PluckThenBowOptions::visit(OptionVisitor& visitor) {
  visitor("scene", "string and bow stroke", {.required = true}, truth.scene);
  visitor("simulator", "how pluck and stroke are simulated", truth.simulator);
  visitor("measurement", "sampling and noise of the stroke", measurement);
  visitor("pluck", "pluck test before the stroke", {.required = true}, pluck);
  visitor("refinement", "search of the frequencies on the stroke", refinement);
  visitor("contact", "search of the contact point", {.required = true}, contact);
  visitor("bound", "calibrate to the bound from the same pluck test, too", has_bound, bound);
  visitor("inversion", "how the reactions are inverted", inversion);
  visitor("score", "where identified and true force are compared", score);
  visitor("seed", "key of the noise", {.range = Range::non_negative()}, seed);
  visitor("figures", "what is drawn of the identification", figures);
}

std::vector<Finding> PluckThenBowOptions::lint() const {
  std::vector<Finding> findings = lint_observation(stroke());
  append(findings, lint_scores(score, stroke()));
  append(findings,
         lint_figures(figures, FigureContent::kParameterCurves, stroke().truth.scene.duration));
  lint_making(findings, "inversion", [&] { InversionRecipe recipe(inversion); });
  lint_making(findings, "refinement.objective", [&] { refinement.objective.make(); });
  lint_making(findings, "refinement.optimizer", [&] { refinement.optimizer.make(); });
  const std::int64_t modes = truth.scene.string.modes;
  if (!(refinement.first_modes <= refinement.law_modes && refinement.law_modes <= modes)) {
    add_finding(findings, "refinement",
                "first_modes is {} and law_modes {}: the law goes through modes that were refined, "
                "so that first_modes <= law_modes <= {}, the modes of the string",
                refinement.first_modes, refinement.law_modes, modes);
  }
  lint_making(findings, "contact.objective", [&] { contact.objective.make(); });
  lint_making(findings, "pluck.initial", [&] {
    const Scene test = pluck_test(pluck.identification.method).truth.scene;
    pluck.start.make();
    if (is_known(test.string)) initial_state(test, make_modal_basis(test.string));
  });
  if (pluck.start.make()->at_rest()) {
    add_finding(
        findings, "pluck.initial",
        "a string at rest has no free decay: pluck it (pluck.initial: {{type: pluck, ...}})");
  }
  lint_making(findings, "pluck.duration", [&] {
    const double rate = measurement.sample_rate;
    require_decay_length(sample_count(pluck.duration, rate), rate, pluck.identification);
  });
  if (has_bound) {
    lint_making(findings, "bound", [&] { bound.require_schedule(); });
    append(findings,
           lint_priors("bound.parameters", bound.parameters.unknowns, truth.scene.string));
  }
  if (!(contact.start - contact.range > 0.0 &&
        contact.start + contact.range < truth.scene.string.length)) {
    add_finding(findings, "contact.range",
                "the search from {:g} m to {:g} m leaves the string of {:g} m: narrow it",
                contact.start - contact.range, contact.start + contact.range,
                truth.scene.string.length);
  }
  return findings;
}

std::vector<PlanLine> PluckThenBowOptions::plan() const {
  const double highest = pluck.identification.highest_frequency;
  std::vector<PlanLine> lines = {
      {fmt::format("pluck test of {:g} s, modes up to {:g} Hz", pluck.duration, highest),
       {{"pluck", {{"duration", pluck.duration}, {"highest_frequency", highest}}}}}};
  lines.push_back(plan_line(*planned_simulations()));
  lines.emplace_back(fmt::format(
      "modes 1 to {} refined by objective {}, optimizer {}; law through modes 1 to {}; "
      "all {} modes "
      "refined; law again; contact by {}",
      refinement.first_modes, refinement.objective.selected(), refinement.optimizer.selected(),
      refinement.law_modes, truth.scene.string.modes, contact.objective.selected()));
  if (has_bound) {
    lines.emplace_back(
        "from the same pluck test: joint likelihood in stages, then its posterior under "
        "the plucked frequencies");
  }
  return lines;
}

std::optional<PlannedSimulations> PluckThenBowOptions::planned_simulations() const {
  auto planned = planned_truths(stroke(), truth_outputs(figures));
  const IdentifyOptions test = pluck_test(pluck.identification.method);
  ObservationOptions plucked = stroke();
  plucked.truth = test.truth;
  plucked.measurement = test.measurement;
  if (planned) add_planned(plucked, *planned);
  return planned;
}

IdentifyOptions PluckThenBowOptions::pluck_test(std::string_view method) const {
  IdentifyOptions test{.truth = truth, .measurement = measurement, .seed = seed};
  Scene& scene = test.truth.scene;
  scene.bow = {.position = truth.scene.bow.position, .velocity = 0.0, .normal_force = 0.0};
  scene.start = pluck.start;
  scene.duration = pluck.duration;
  test.measurement.noise_level = pluck.noise_level;
  test.identification = pluck.identification;
  test.identification.method = method;
  return test;
}

ObservationOptions PluckThenBowOptions::stroke() const {
  ObservationOptions observation;
  observation.has_scene = true;
  observation.truth = truth;
  observation.measurement = measurement;
  return observation;
}

}  // namespace modcal
