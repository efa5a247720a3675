#include "experiments/kinds/limit/calibration_limit_experiment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "experiments/kinds/lint.hpp"
#include "experiments/study/fingerprint.hpp"
#include "libcalib/calibration.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// The truth with the start's errors, drawn from the seed alone: equal at every noise level.
ModelPoint start_of(const ModelPoint& truth, ModelErrorOptions errors, const StreamKey& key) {
  double draw[1];
  fill_uniform(key.with("contact error"), draw);
  errors.contact *= 2.0 * draw[0] - 1.0;
  const AssumedModel model =
      with_errors(truth.basis, truth.contact, errors, key.with("model error"));
  return {model.basis, model.contact};
}

double median_error(const ModalBasis& found, const ModelPoint& truth) {
  const std::vector<double> shape = truth.basis.shape_at(truth.contact);
  std::vector<double> errors;
  for (std::size_t n = 0; n < found.size(); ++n) {
    if (std::abs(shape[n]) < 0.1) continue;
    errors.push_back(std::abs(found.omega[n] / truth.basis.omega[n] - 1.0));
  }
  return quantile(std::move(errors), 0.5);
}

void add_noise(const StreamKey& key, NoisyRecords& records) {
  for (std::size_t r = 0; r < 2; ++r) {
    std::vector<double> noise(records.samples());
    fill_standard_normal(key.with("measurement noise").with(std::uint64_t{r}), noise);
    for (std::size_t j = 0; j < noise.size(); ++j) {
      records.reactions[r][j] += records.deviation[r] * noise[j];
    }
    remove_mean(records.reactions[r]);
  }
}

LimitOutcome outcome_of(const ContinuationResult& found) {
  LimitOutcome outcome{
      .law = {found.law.fundamental, found.law.inharmonicity, found.law.contact, found.law.damping},
      .law_deviation = found.law.deviation,
      .contact = found.model.contact,
      .contact_deviation = found.contact_deviation,
      .sensors = {found.model.sensors.gain, found.model.sensors.delay,
                  0.5 * found.model.sensors.corner / std::numbers::pi},
      .sensor_deviation = found.sensor_deviation,
      .law_chi2 = found.law.chi2,
      .chi2 = found.chi2,
      .chi2_deviation = found.chi2_deviation,
      .fits = found.fits,
      .priors_hold = !found.priors.contradicted(),
      .paper_error = kNan,
      .force_correlation = kNan};
  for (const ModeVerdict& mode : found.modes) {
    outcome.frequencies.push_back(mode.frequency);
    outcome.deviations.push_back(mode.deviation);
  }
  return outcome;
}

double force_correlation(const LimitTruth& truth, double level, const ModelPoint& model,
                         const InversionRecipe& recipe) {
  Observation observation{.sample_rate = truth.records.sample_rate,
                          .basis = truth.point.basis,
                          .contact = truth.point.contact,
                          .fundamental = truth.point.basis.frequency(0),
                          .noise_level = level,
                          .truth = truth.simulated,
                          .reference = truth.simulated->simulation.force};
  for (std::size_t r = 0; r < 2; ++r) {
    observation.reactions[r] = Signal{.quantity = r == 0 ? "R1" : "R2",
                                      .unit = "N",
                                      .sample_rate = truth.records.sample_rate,
                                      .samples = truth.records.reactions[r]};
  }
  const double duration = observation.reactions[0]->duration();
  const ScoreOptions score{.whole = {0.1 * duration, 0.95 * duration}};
  const auto estimator = prepare_estimator({model.basis, model.contact}, observation, recipe);
  const std::vector<SideIdentification> sides =
      identify(observation, *estimator, recipe, {.force = true}, &score);
  return sides.front().whole.correlation;
}

// The farthest starts that a seed may draw, and the band of the calibration.
void lint_start(const CalibrationLimitOptions& options, std::vector<Finding>& findings) {
  const Scene& scene = options.observation.truth.scene;
  const bool sound = std::none_of(findings.begin(), findings.end(),
                                  [](const Finding& finding) { return finding.is_error; });
  if (!sound || !is_known(scene.string)) return;
  const ModalBasis basis = make_modal_basis(scene.string);
  lint_making(findings, "model_error", [&] {
    for (const double sign : {1.0, -1.0}) {
      ModelErrorOptions errors = options.model_error;
      errors.contact *= sign;
      with_errors(basis, scene.bow.position, errors, StreamKey(1));
    }
  });
  lint_making(findings, "continuation", [&] {
    likelihood_band({basis, scene.bow.position}, options.continuation.highest_frequency,
                    options.observation.measurement.sample_rate);
  });
}

}  // namespace

void CalibrationLimitOptions::visit(OptionVisitor& visitor) {
  observation.visit(visitor);
  visitor.section({.key = "model_error",
                   .meaning = "bounds of the start's errors: uniform, drawn for each seed"},
                  model_error);
  visitor.section({.key = "continuation", .meaning = "how the calibration is done"}, continuation);
  visitor.numbers({.key = "noise_levels",
                   .meaning = "noise standard deviations over those of the signals",
                   .unit = "1",
                   .range = Range::non_negative()},
                  noise_levels);
  visitor.integer({.key = "seeds", .meaning = "noise draws a level", .range = Range::at_least(1)},
                  seeds);
  visitor.integer(
      {.key = "seed", .meaning = "key of noise and starts", .range = Range::non_negative()}, seed);
  visitor.flag({.key = "known_noise",
                .meaning = "the calibration is told the noise level, where there is any"},
               known_noise);
  visitor.flag({.key = "paper_method", .meaning = "draw the paper's method from the same starts"},
               paper_method);
  visitor.optional_group(
      {.key = "inversion", .meaning = "identify the force with the calibrated model as well"},
      has_inversion, [this](OptionVisitor& members) { inversion.visit(members); });
}

LimitQuestion limit_question_of(const CalibrationLimitOptions& options, double noise_level) {
  LimitQuestion question{.observation = options.observation, .noise_level = noise_level};
  question.calibrate_by(options.continuation);
  return question;
}

std::vector<Finding> CalibrationLimitExperiment::lint() const {
  std::vector<Finding> findings;
  if (!options_.observation.has_scene) {
    add_finding(findings, "record",
                "a bound needs a truth, which a record does not have: state a "
                "scene");
  } else {
    const ObservationOptions& observation = options_.observation;
    append(findings, lint_scene(observation.truth.scene, observation.truth.simulator,
                                observation.measurement));
    lint_start(options_, findings);
  }
  append(findings, lint_priors("continuation.unknowns", options_.continuation.unknowns,
                               options_.observation.string_model()));
  if (options_.noise_levels.empty()) {
    add_finding(findings, "noise_levels", "no noise level is stated");
  }
  return findings;
}

std::vector<std::string> CalibrationLimitExperiment::plan() const {
  std::vector<std::string> lines;
  if (const auto planned = planned_simulations()) lines.push_back(plan_line(*planned));
  lines.push_back(fmt::format("tasks: {} calibrations ({} noise levels, {} seeds)", task_count(),
                              options_.noise_levels.size(), options_.seeds));
  return lines;
}

std::optional<PlannedSimulations> CalibrationLimitExperiment::planned_simulations() const {
  return planned_truths(options_.observation, {.left_reaction = true, .right_reaction = true});
}

LimitQuestion CalibrationLimitExperiment::limit_question() const {
  return limit_question_of(options_, options_.noise_levels.front());
}

std::vector<std::string> CalibrationLimitExperiment::axis_values(std::size_t task) const {
  return {fmt::format("{:g}", level_of(task)),
          std::to_string(task % static_cast<std::size_t>(options_.seeds))};
}

std::string CalibrationLimitExperiment::fingerprint(std::size_t task,
                                                    const std::filesystem::path&) const {
  Options options = options_;
  options.noise_levels = {level_of(task)};
  options.seeds = 1;
  return fmt::format("calibration_limit {} ", task % static_cast<std::size_t>(options_.seeds)) +
         modcal::fingerprint([&](OptionVisitor& visitor) { options.visit(visitor); });
}

std::string CalibrationLimitExperiment::run_task(std::size_t task,
                                                 const StudyContext& context) const {
  const auto draw = static_cast<std::uint64_t>(task % static_cast<std::size_t>(options_.seeds));
  LimitOutcome outcome;
  try {
    outcome = calibrate_draw(level_of(task), draw, context.work.truths);
  } catch (const InvalidInput& error) {
    outcome.failure = error.what();
  }
  return outcome_text(outcome);
}

LimitOutcome CalibrationLimitExperiment::calibrate_draw(double level, std::uint64_t draw,
                                                        TruthCache& truths) const {
  const StreamKey key = StreamKey(static_cast<std::uint64_t>(options_.seed)).with(draw);
  LimitTruth truth = limit_truth(options_.observation, level, truths, options_.has_inversion);
  // Every level has its own noise, so that levels are independent; starts are the same at all.
  if (level > 0.0) add_noise(key.with(level), truth.records);
  const CalibrationData data = CalibrationData::of_records(
      truth.records.reactions[0], truth.records.reactions[1], truth.records.sample_rate);
  const ModelPoint start = start_of(truth.point, options_.model_error, key);
  ContinuationOptions continuation = options_.continuation;
  if (options_.known_noise && level > 0.0) {
    continuation.left_noise = truth.records.deviation[0];
    continuation.right_noise = truth.records.deviation[1];
  }
  const ContinuationResult found = calibrate_by_continuation(start, data, continuation);
  LimitOutcome outcome = outcome_of(found);
  if (options_.paper_method) {
    CalibrationOptions paper;
    paper.parameters.frequencies = "all";
    outcome.paper_error = median_error(calibrate(start, data, paper).model.basis, truth.point);
  }
  if (options_.has_inversion) {
    outcome.force_correlation =
        force_correlation(truth, level, found.model, InversionRecipe(options_.inversion));
  }
  return outcome;
}

std::string CalibrationLimitExperiment::failure_in(const std::string& outcome) const {
  return read_limit_outcome(outcome).failure;
}

StudyResult CalibrationLimitExperiment::sum_up(const TaskOutcomes& outcomes,
                                               const StudyContext& context) const {
  std::vector<LimitLevel> levels;
  for (const double level : options_.noise_levels) levels.push_back({.noise_level = level});
  std::size_t pending = 0;
  for (std::size_t task = 0; task < outcomes.size(); ++task) {
    if (!outcomes[task]) {
      ++pending;
      continue;
    }
    levels[task / static_cast<std::size_t>(options_.seeds)].outcomes.push_back(
        read_limit_outcome(outcomes[task]->outcome));
  }
  StudyResult result = sum_up_limit(options_, levels, context);
  result.pending_tasks = pending;
  return result;
}

StudyResult CalibrationLimitExperiment::replay(std::size_t task,
                                               const StudyContext& context) const {
  Options one = options_;
  one.noise_levels = {level_of(task)};
  return sum_up_limit(
      one,
      {{.noise_level = level_of(task), .outcomes = {read_limit_outcome(run_task(task, context))}}},
      context);
}

}  // namespace modcal
