#include "experiments/kinds/section7/pluck_then_bow.hpp"
#include "libcalib/optimizers/gsl_optimizer.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {

DampingFit damping_of(const PluckIdentification& found, std::int64_t degree) {
  std::vector<std::size_t> numbers;
  std::vector<double> ratios;
  for (const auto& [number, mode] : found.modes) {
    numbers.push_back(number);
    ratios.push_back(mode.pole.damping_ratio);
  }
  return fit_damping(numbers, ratios, static_cast<std::size_t>(degree));
}

ModalBasis law_basis(const PluckThenBowOptions& options, const StiffStringFit& law,
                     const DampingFit& damping, std::size_t modes) {
  StringModel string = options.truth.scene.string;
  string.modes = static_cast<std::int64_t>(modes);
  std::vector<double> frequencies;
  for (std::size_t n = 1; n <= modes; ++n) frequencies.push_back(law.frequency(n));
  ModalBasis basis = with_frequencies(make_modal_basis(string), frequencies);
  for (std::size_t n = 1; n <= modes; ++n) {
    const double ratio = damping.ratio(n);
    MODCAL_REQUIRE(ratio > 0.0 && ratio < 1.0,
                   "the damping polynomial of the pluck test gives zeta = {:g} for mode {}: lower "
                   "pluck.damping_degree or raise pluck.identification.highest_frequency",
                   ratio, n);
    basis.zeta[n - 1] = ratio;
  }
  return basis;
}

namespace {

StiffStringFit law_of_basis(const ModalBasis& basis, std::size_t modes) {
  std::vector<double> frequencies = frequencies_of(basis);
  frequencies.resize(std::min(modes, basis.size()));
  return fit_stiff_string(frequencies);
}

/// The modes of the pluck test; a mode that it missed follows the law of the others.
ModalBasis plucked_basis(const PluckThenBowOptions& options, const PluckThenBowOutcome& outcome) {
  const PluckIdentification& found = outcome.pluck.found;
  const std::size_t modes = std::min(found.modes.back().number,
                                     static_cast<std::size_t>(options.truth.scene.string.modes));
  ModalBasis basis = law_basis(options, *outcome.pluck.law, outcome.damping, modes);
  for (const auto& [number, mode] : found.modes) {
    if (number > modes) continue;
    basis.omega[number - 1] *= mode.pole.frequency / basis.frequency(number - 1);
    basis.zeta[number - 1] = mode.pole.damping_ratio;
  }
  return basis;
}

CalibrationOutcome refine(const PluckThenBowOptions& options, const Observation& stroke,
                          const AssumedModel& start, std::size_t modes,
                          const StudyContext& context) {
  const RefinementOptions& refinement = options.refinement;
  CalibrationOptions calibration{.parameters = {.frequencies = "listed"},
                                 .objective = refinement.objective,
                                 .optimizer = refinement.optimizer,
                                 .budget = refinement.budget,
                                 .excitation_threshold = refinement.excitation_threshold};
  for (std::size_t n = 1; n <= modes; ++n) {
    calibration.parameters.modes.push_back(static_cast<std::int64_t>(n));
  }
  CalibrationOutcome outcome{.initial = start};
  outcome.result = calibrate({start.basis, start.contact}, calibration_data(stroke), calibration,
                             polling_clock(context));
  outcome.refined = {outcome.result.model.basis, outcome.result.model.contact};
  outcome.true_frequencies = frequencies_of(stroke.basis);
  return outcome;
}

/// Modes that the contact does not excite get the frequencies of the law through the others.
ModelStage with_law(const PluckThenBowOptions& options, const AssumedModel& refined) {
  const std::vector<bool> excited =
      excited_modes({refined.basis, refined.contact}, options.refinement.excitation_threshold);
  const std::vector<double> weights(excited.begin(), excited.end());
  const std::vector<double> frequencies = frequencies_of(refined.basis);
  const StiffStringFit law = fit_stiff_string(frequencies, weights);
  return {
      .key = "law_again",
      .title = "law fitted again, unexcited modes from it",
      .model = {with_frequencies(refined.basis, fill_unexcited_modes(frequencies, excited, law)),
                refined.contact},
      .law = law};
}

ContactCurve contact_curve(const PluckThenBowOptions& options, const CalibrationData& data,
                           const AssumedModel& model) {
  const ContactSearchOptions& search = options.contact;
  const std::vector<std::string> names = {"x_c"};
  const ParameterSet parameters({model.basis, model.contact}, names, {.contact = search.range});
  const auto function = search.objective.make()->bind(data, parameters);
  ContactCurve curve;
  for (std::int64_t j = 0; j < search.points; ++j) {
    const double share = static_cast<double>(j) / static_cast<double>(search.points - 1);
    curve.positions.push_back(search.start + search.range * (2.0 * share - 1.0));
    curve.values.push_back(function->value(std::span(&curve.positions.back(), 1)));
  }
  return curve;
}

/// The lowest point of the curve, then Brent's search between its neighbors.
ModelStage with_contact(const PluckThenBowOptions& options, const CalibrationData& data,
                        const ModelStage& before, const ContactCurve& curve,
                        const StudyContext& context) {
  const auto lowest = std::min_element(curve.values.begin(), curve.values.end());
  const ModelPoint start{before.model.basis,
                         curve.positions[static_cast<std::size_t>(lowest - curve.values.begin())]};
  CalibrationOptions calibration{.parameters = {.contact = true},
                                 .objective = options.contact.objective};
  calibration.parameters.ranges.contact = curve.positions[1] - curve.positions[0];
  calibration.optimizer = Choice<Optimizer>::of<GslOptimizer>("gsl", {.algorithm = "brent"});
  const CalibrationResult found = calibrate(start, data, calibration, polling_clock(context));
  ModelStage stage = before;
  stage.key = "contact";
  stage.title = "contact point adjusted";
  stage.model.contact = found.model.contact;
  stage.evaluations = found.search.evaluations + static_cast<std::int64_t>(curve.values.size());
  return stage;
}

std::vector<SideIdentification> identified(const PluckThenBowOptions& options,
                                           const Observation& stroke, const AssumedModel& model) {
  return identify(stroke, model, options.inversion, inversion_outputs(options.figures, false),
                  &options.score);
}

void take_paper_route(const PluckThenBowOptions& options, const StudyContext& context,
                      PluckThenBowOutcome& outcome) {
  const CalibrationData data = calibration_data(outcome.stroke);
  const auto first_modes = static_cast<std::size_t>(options.refinement.first_modes);
  const auto law_modes = static_cast<std::size_t>(options.refinement.law_modes);
  const auto modes = static_cast<std::size_t>(options.truth.scene.string.modes);
  const AssumedModel plucked{plucked_basis(options, outcome), options.contact.start};
  MODCAL_REQUIRE(plucked.basis.size() >= std::max(first_modes, law_modes),
                 "the pluck test found modes up to {}, refinement asks for {} and {}: lower "
                 "first_modes and law_modes or raise pluck.identification.highest_frequency",
                 plucked.basis.size(), first_modes, law_modes);
  outcome.stages.push_back({.key = "pluck",
                            .title = "pluck test",
                            .model = plucked,
                            .law = law_of_basis(plucked.basis, law_modes)});
  outcome.first = refine(options, outcome.stroke, plucked, first_modes, context);
  const StiffStringFit law = law_of_basis(outcome.first.refined.basis, law_modes);
  outcome.stages.push_back({.key = "first_refined",
                            .title = fmt::format("first {} refined", first_modes),
                            .model = outcome.first.refined,
                            .law = law_of_basis(outcome.first.refined.basis, first_modes),
                            .evaluations = outcome.first.result.search.evaluations});
  const AssumedModel start{law_basis(options, law, outcome.damping, modes), options.contact.start};
  outcome.stages.push_back({.key = "law",
                            .title = fmt::format("law extended to {} modes", modes),
                            .model = start,
                            .law = law});
  context.throw_if_interrupted();
  outcome.all = refine(options, outcome.stroke, start, modes, context);
  const ModelStage again = with_law(options, outcome.all.refined);
  outcome.stages.push_back({.key = "refined",
                            .title = fmt::format("{} modes refined", modes),
                            .model = outcome.all.refined,
                            .law = again.law,
                            .evaluations = outcome.all.result.search.evaluations});
  outcome.stages.push_back(again);
  outcome.curve = contact_curve(options, data, again.model);
  outcome.stages.push_back(with_contact(options, data, again, outcome.curve, context));
  context.throw_if_interrupted();
  outcome.sides = identified(options, outcome.stroke, outcome.stages.back().model);
}

// Median and largest |f_n/f_n(truth) − 1| over the modes the contact excites.
void set_errors(const Observation& stroke, double excitation_threshold, ModelStage& stage) {
  const std::vector<bool> excited =
      excited_modes({stroke.basis, stroke.contact}, excitation_threshold);
  std::vector<double> errors;
  for (std::size_t n = 0; n < stage.model.basis.size(); ++n) {
    if (!excited[n]) continue;
    errors.push_back(std::abs(stage.model.basis.omega[n] / stroke.basis.omega[n] - 1.0));
  }
  stage.median_error = quantile(errors, 0.5);
  stage.largest_error = *std::max_element(errors.begin(), errors.end());
}

}  // namespace

PluckThenBowOutcome pluck_then_bow(const PluckThenBowOptions& options,
                                   const StudyContext& context) {
  PluckThenBowOutcome outcome;
  outcome.pluck =
      identify_outcome(options.pluck_test(options.pluck.identification.method), context);
  outcome.likelihood = identify_outcome(options.pluck_test("maximum_likelihood"), context);
  MODCAL_REQUIRE(outcome.pluck.law && outcome.likelihood.law,
                 "the pluck test identifies fewer than two modes: pluck harder, elsewhere or with "
                 "less noise");
  outcome.damping = damping_of(outcome.pluck.found, options.pluck.damping_degree);
  outcome.stroke =
      observe(options.stroke(), truth_outputs(options.figures), context.work.truths,
              options.key().with("stroke"), context.folder, options.score.oversampling);
  take_paper_route(options, context, outcome);
  outcome.has_bound = options.has_bound;
  if (options.has_bound) {
    add_bound_stages(options, context, outcome);
    outcome.bound_sides = identified(options, outcome.stroke, outcome.bound_stages.back().model);
  }
  for (auto* stages : {&outcome.stages, &outcome.bound_stages}) {
    for (ModelStage& stage : *stages) {
      set_errors(outcome.stroke, options.refinement.excitation_threshold, stage);
    }
  }
  const StringModel& string = options.truth.scene.string;
  outcome.truth = {
      .key = "truth",
      .title = "truth",
      .model = {outcome.stroke.basis, outcome.stroke.contact},
      .law = {.fundamental = string.fundamental, .inharmonicity = string.inharmonicity}};
  return outcome;
}

}  // namespace modcal
