#include "experiments/kinds/limit/limit.hpp"
#include "experiments/kinds/limit/structure_limit.hpp"
#include "experiments/study/sample.hpp"

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
      .sensor_deviation = found.sensor_deviation,
      .law_chi2 = found.law.chi2,
      .chi2 = found.chi2,
      .chi2_deviation = found.chi2_deviation,
      .fits = found.fits,
      .priors_hold = !found.priors.contradicted(),
      .paper_error = kNan,
      .force_correlation = kNan};
  for (std::size_t i = 0; i < Sensor::kCount; ++i) {
    outcome.sensors[i] = sensor_value(i, found.model.sensors);
  }
  for (const ModeVerdict& mode : found.modes) {
    outcome.frequencies.push_back(mode.frequency);
    outcome.deviations.push_back(mode.deviation);
  }
  return outcome;
}

double force_correlation(const LimitTruth& truth, double level, const ModelPoint& model,
                         const InversionOptions& inversion) {
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
  return identify(observation, {model.basis, model.contact}, inversion, {.force = true}, &score)
      .front()
      .whole.correlation;
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
  lint_making(findings, "calibration.objective", [&] {
    likelihood_band({basis, scene.bow.position},
                    options.calibration.objective.make()->highest_frequency(),
                    options.observation.measurement.sample_rate);
  });
}

}  // namespace

void CalibrationLimitOptions::visit(OptionVisitor& visitor) {
  observation.visit(visitor);
  visitor("structure", "any structure under a bow, in the place of a string", has_structure,
          structure);
  visitor("model_error", "bounds of the start's errors: uniform, drawn for each seed", model_error);
  visitor("calibration", "how the calibration is done", calibration);
  visitor("noise_levels", "noise standard deviations over those of the signals",
          {.range = Range::non_negative()}, noise_levels);
  visitor("seeds", "noise draws a level", {.range = Range::closed(1, 10000)}, seeds);
  visitor("seed", "key of noise and starts", {.range = Range::non_negative()}, seed);
  visitor("known_noise", "the calibration is told the noise level, where there is any",
          known_noise);
  visitor("paper_method", "draw the paper's method from the same starts", paper_method);
  visitor("inversion", "identify the force with the calibrated model as well", has_inversion,
          inversion);
}

std::shared_ptr<const Experiment> CalibrationLimitRecipe::make() const {
  if (options_.has_structure) return std::make_shared<const StructureLimitExperiment>(options_);
  return std::make_shared<const CalibrationLimitExperiment>(options_);
}

std::vector<SweepAxis> axes_of(const CalibrationLimitOptions& options) {
  return {axis_of("noise_level", options.noise_levels.size(),
                  [&](std::size_t i) { return fmt::format("{:g}", options.noise_levels[i]); }),
          axis_of("seed", static_cast<std::size_t>(options.seeds),
                  [](std::size_t i) { return std::to_string(i); })};
}

CalibrationLimitExperiment::CalibrationLimitExperiment(Options options)
    : ProductExperiment(axes_of(options)), options_(std::move(options)) {}

void lint_levels(const std::vector<double>& levels, std::vector<Finding>& findings) {
  if (levels.empty()) add_finding(findings, "noise_levels", "no noise level is stated");
  for (std::size_t i = 1; i < levels.size(); ++i) {
    const auto before = levels.begin() + static_cast<std::ptrdiff_t>(i);
    if (std::find(levels.begin(), before, *before) == before) continue;
    add_finding(findings, fmt::format("noise_levels.{}", i),
                "the noise level {:g} % stands here twice: leave one of them, or raise seeds",
                100.0 * *before);
  }
}

LimitQuestion limit_question_of(const CalibrationLimitOptions& options, double noise_level) {
  LimitQuestion question{.observation = options.observation, .noise_level = noise_level};
  question.calibrate_by(options.calibration);
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
  lint_making(findings, "calibration", [&] { options_.calibration.require_schedule(); });
  append(findings, lint_priors("calibration.parameters", options_.calibration.parameters.unknowns,
                               options_.observation.string_model()));
  lint_levels(options_.noise_levels, findings);
  return findings;
}

std::vector<PlanLine> CalibrationLimitExperiment::plan() const {
  std::vector<PlanLine> lines;
  if (const auto planned = planned_simulations()) lines.push_back(plan_line(*planned));
  lines.push_back({fmt::format("tasks: {} calibrations ({} noise levels, {} seeds)", task_count(),
                               options_.noise_levels.size(), options_.seeds),
                   {{"tasks", task_count()},
                    {"noise_levels", options_.noise_levels.size()},
                    {"seeds", options_.seeds}}});
  return lines;
}

std::optional<PlannedSimulations> CalibrationLimitExperiment::planned_simulations() const {
  return planned_truths(options_.observation, {.left_reaction = true, .right_reaction = true});
}

std::shared_ptr<const LimitQuestion> CalibrationLimitExperiment::limit_question() const {
  return std::make_shared<const LimitQuestion>(
      limit_question_of(options_, options_.noise_levels.front()));
}

// Of a cell: any list that has it shares its outcome.
std::string CalibrationLimitExperiment::fingerprint(std::size_t task,
                                                    const std::filesystem::path&) const {
  Options options = options_;
  options.noise_levels = {level_of(task)};
  options.seeds = 1;
  return fmt::format("calibration_limit {} ", place(task, 1)) +
         modcal::fingerprint([&](OptionVisitor& visitor) { options.visit(visitor); });
}

std::string CalibrationLimitExperiment::run_task(std::size_t task,
                                                 const StudyContext& context) const {
  return report::json_line(attempted([&] { return calibrate_draw(task, context.work.truths); }));
}

LimitOutcome CalibrationLimitExperiment::calibrate_draw(std::size_t task,
                                                        TruthCache& truths) const {
  const double level = level_of(task);
  const StreamKey key =
      StreamKey(static_cast<std::uint64_t>(options_.seed)).with(std::uint64_t{place(task, 1)});
  LimitTruth truth =
      limit_truth(options_.observation, level, truths, {.force = options_.has_inversion});
  // Every level has its own noise, so that levels are independent; starts are the same at all.
  if (level > 0.0) add_noise(key.with(level), truth.records);
  const CalibrationData data = CalibrationData::of_records(
      truth.records.reactions[0], truth.records.reactions[1], truth.records.sample_rate);
  const ModelPoint start = start_of(truth.point, options_.model_error, key);
  CalibrationRecord record{.data = data};
  if (options_.known_noise && level > 0.0) record.noise = truth.records.deviation;
  const CalibrationResult calibrated =
      calibrate(start, std::vector{std::move(record)}, options_.calibration);
  const ContinuationResult& found = *calibrated.continuation;
  LimitOutcome outcome = outcome_of(found);
  if (options_.paper_method) {
    outcome.paper_error =
        median_error(calibrate(start, data, calibration_of_the_paper()).model.basis, truth.point);
  }
  if (options_.has_inversion) {
    outcome.force_correlation = force_correlation(truth, level, found.model, options_.inversion);
  }
  return outcome;
}

StudyResult CalibrationLimitExperiment::sum_up(const TaskOutcomes& outcomes,
                                               const StudyContext& context) const {
  std::vector<LimitLevel> levels;
  for (const double level : options_.noise_levels) levels.push_back({.noise_level = level});
  StudyResult result;
  const auto modes = static_cast<std::size_t>(options_.observation.truth.scene.string.modes);
  const auto read = [modes](const std::string& text) {
    auto outcome = read_outcome<LimitOutcome>(text);
    const bool whole = outcome.frequencies.size() == modes && outcome.deviations.size() == modes;
    MODCAL_REQUIRE(whole || !outcome.failure.empty(),
                   "the stored outcome of a task has {} frequencies and {} deviations of {} modes",
                   outcome.frequencies.size(), outcome.deviations.size(), modes);
    return outcome;
  };
  const auto take = [&](std::size_t task, LimitOutcome outcome, double /*seconds*/) {
    levels[place(task, 0)].outcomes.push_back(std::move(outcome));
  };
  for_each_outcome<LimitOutcome>(outcomes, result, take, read);
  sum_up_limit(options_, levels, context, result);
  return result;
}

StudyResult CalibrationLimitExperiment::replay(std::size_t task,
                                               const StudyContext& context) const {
  Options one = options_;
  one.noise_levels = {level_of(task)};
  LimitLevel level{.noise_level = level_of(task)};
  level.outcomes = {attempted([&] { return calibrate_draw(task, context.work.truths); })};
  StudyResult result;
  result.failed_tasks = level.outcomes[0].failure.empty() ? 0 : 1;
  sum_up_limit(one, {level}, context, result);
  return result;
}

void LimitOutcome::visit(ResultVisitor& visitor) {
  visitor({.key = "failure", .optional = true}, failure);
  if (!failure.empty()) return;
  bool all = right();
  visitor({.key = "law"}, law);
  visitor({.key = "law_deviation"}, law_deviation);
  visitor({.key = "frequencies"}, frequencies);
  visitor({.key = "deviations"}, deviations);
  visitor({.key = "contact"}, contact);
  visitor({.key = "contact_deviation"}, contact_deviation);
  visitor({.key = "sensors"}, sensors);
  visitor({.key = "sensor_deviation"}, sensor_deviation);
  visitor({.key = "law_chi2"}, law_chi2);
  visitor({.key = "chi2"}, chi2);
  visitor({.key = "chi2_deviation"}, chi2_deviation);
  visitor({.key = "right"}, all);
  visitor({.key = "fits"}, fits);
  visitor({.key = "priors_hold"}, priors_hold);
  visitor({.key = "paper_error"}, paper_error);
  visitor({.key = "force_correlation"}, force_correlation);
}

}  // namespace modcal
