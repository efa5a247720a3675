#include "experiments/kinds/benchmark/benchmark.hpp"
#include "experiments/kinds/calibrate/calibrate_force.hpp"

namespace modcal {
namespace {

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

// The objective where the model is right: one evaluation with the truth as initial model.
double value_at_truth(const CalibrateOptions& options, const Observation& observation) {
  CalibrateOptions at_truth = options;
  at_truth.inversion.model_error = {};
  at_truth.calibration.optimizer = Choice<Optimizer>("nlopt");
  at_truth.calibration.budget = {.evaluations = 1};
  return calibrate_observation(at_truth, observation).result.search.initial_value;
}

// NaN where the bound does not exist: the calibration is scored all the same.
double bound_of(const CalibrateOptions& options, const CalibrationOutcome& calibrated,
                FrequencyBounds& bounds, TruthCache& truths) {
  std::vector<std::size_t> modes;
  for (const CalibratedMode& mode : calibrated.result.modes) {
    if (mode.excited) modes.push_back(mode.number);
  }
  try {
    return rms_bound(bounds.of(options, truths), modes);
  } catch (const InvalidInput&) {
    return std::numeric_limits<double>::quiet_NaN();
  }
}

double mean_correlation(const CalibrateOptions& options, const Observation& observation,
                        const AssumedModel& refined) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const SideIdentification& side : identify(observation, refined, options.inversion.inversion,
                                                 {.force = true}, &options.inversion.score)) {
    for (const WindowScore& score : side.scores) {
      sum += score.correlation;
      ++count;
    }
  }
  return sum / static_cast<double>(count);
}

// The first, the last and evenly spaced ones between.
std::vector<std::pair<std::int64_t, double>> thinned(const std::vector<TracePoint>& trace) {
  std::vector<std::pair<std::int64_t, double>> points;
  for (const std::size_t i : spread_indices(trace.size(), 100)) {
    points.emplace_back(trace[i].evaluations, trace[i].value);
  }
  return points;
}

BenchmarkOutcome score(const CalibrateOptions& options, const SuccessOptions& success,
                       const Observation& observation, const CalibrationOutcome& calibrated) {
  const OptimizationResult& search = calibrated.result.search;
  BenchmarkOutcome outcome{.stop = search.stop,
                           .evaluations = search.evaluations,
                           .initial_value = search.initial_value,
                           .value = search.value};
  outcome.truth_value = value_at_truth(options, observation);
  const std::vector<double> errors = frequency_errors(calibrated);
  outcome.initial_error = quantile(frequency_errors(calibrated, true), 0.5);
  outcome.frequency_error = quantile(errors, 0.5);
  outcome.frequency_rms_error = rms(errors);
  outcome.contact_error = std::abs(calibrated.refined.contact - observation.contact);
  outcome.correlation =
      mean_correlation(options, with_sensors_alike(observation, calibrated.result.model.sensors),
                       calibrated.refined);
  outcome.success =
      outcome.frequency_error <= success.frequency_error &&
      (!options.calibration.parameters.contact || outcome.contact_error <= success.contact_error);
  outcome.trace = thinned(search.trace);
  return outcome;
}

// Unknowns of the law in the order of ExpectedLimit::law.
enum Unknown : std::size_t { kFundamental, kInharmonicity, kContact, kDamping, kUnknowns };
using UnknownsCovariance = std::array<std::array<double, kUnknowns>, kUnknowns>;

// Covariance of the others where one unknown is known after all.
void know(Unknown known, UnknownsCovariance& c) {
  if (!(c[known][known] > 0.0)) return;  // fixed already
  const UnknownsCovariance before = c;
  for (std::size_t i = 0; i < kUnknowns; ++i) {
    for (std::size_t j = 0; j < kUnknowns; ++j) {
      c[i][j] -= before[i][known] * before[known][j] / before[known][known];
    }
  }
}

std::vector<double> law_bounds(const ExpectedLimit& limit, const CalibrateOptions& options,
                               const ModalBasis& basis) {
  const StiffStringFit law = fit_stiff_string(frequencies_of(basis));
  std::array<double, kUnknowns> deviation = limit.law;
  deviation[kFundamental] /= law.fundamental;
  UnknownsCovariance c{};
  for (std::size_t i = 0; i < kUnknowns; ++i) {
    for (std::size_t j = 0; j < kUnknowns; ++j) {
      c[i][j] = limit.law_correlation[i][j] * deviation[i] * deviation[j];
    }
  }
  if (!options.calibration.parameters.contact) {
    know(kContact, c);
  }
  std::vector<double> bounds;
  for (std::size_t n = 1; n <= basis.size(); ++n) {
    // ln f_n = ln f_0 + ln n + ln(1 + B n²)/2
    const auto square = static_cast<double>(n * n);
    const double slope = 0.5 * square / (1.0 + law.inharmonicity * square);
    const double variance = c[kFundamental][kFundamental] +
                            2.0 * slope * c[kFundamental][kInharmonicity] +
                            slope * slope * c[kInharmonicity][kInharmonicity];
    bounds.push_back(std::sqrt(std::max(variance, 0.0)));
  }
  return bounds;
}

std::vector<double> bounds_of(const CalibrateOptions& options, TruthCache& truths) {
  const ObservationOptions& observation = options.inversion.observation;
  LimitQuestion question{.observation = observation,
                         .noise_level = observation.measurement.noise_level};
  question.calibrate_by(options.calibration);
  // The outputs of the task's own truth, so that both share one simulation.
  const LimitCase records = limit_case(question, truths, {.force = true});
  const ExpectedLimit limit = expected_limit(records);
  if (options.calibration.parameters.no_frequency()) {
    return law_bounds(limit, options, records.truth.basis);
  }
  std::vector<double> bounds;
  for (const ModeVerdict& mode : limit.modes) bounds.push_back(mode.deviation);
  return bounds;
}

std::string key_of(const CalibrateOptions& options) {
  const ObservationOptions& observation = options.inversion.observation;
  const CalibrationOptions& calibration = options.calibration;
  LimitQuestion question;
  question.calibrate_by(calibration);
  const std::string unknowns =
      fingerprint([&](OptionVisitor& visitor) { question.unknowns.visit(visitor); });
  return fmt::format("{} {:a} {} {} {} {:a} {:a} {}",
                     truth_key(observation.truth, observation.measurement.sample_rate, {}),
                     observation.measurement.noise_level, calibration.parameters.frequencies,
                     calibration.parameters.contact, calibration.by_schedule(),
                     question.highest_frequency, question.law_width, unknowns);
}

}  // namespace

void SuccessOptions::visit(OptionVisitor& visitor) {
  const auto members = [this](OptionVisitor& inner) {
    inner("frequency_error", "largest median relative frequency error of the excited modes",
          {.range = Range::positive()}, frequency_error);
    inner("contact_error", "largest error of the contact point, where it is free",
          {.unit = "m", .range = Range::positive()}, contact_error);
  };
  visitor.group({.key = "success", .meaning = "when a calibration counts as right"}, members);
}

BenchmarkOutcome run_benchmark_cell(const CalibrateOptions& options, const SuccessOptions& success,
                                    FrequencyBounds& bounds, const StudyContext& context) {
  const InvertOptions& inversion = options.inversion;
  const Observation observation = observe(inversion.observation, {.force = true},
                                          context.work.truths, inversion.key(), context.folder);
  const CalibrationOutcome calibrated =
      calibrate_observation(options, observation, polling_clock(context));
  BenchmarkOutcome outcome = score(options, success, observation, calibrated);
  outcome.frequency_bound = bound_of(options, calibrated, bounds, context.work.truths);
  return outcome;
}

void BenchmarkOutcome::visit(ResultVisitor& visitor) {
  visitor({.key = "failure", .optional = true}, failure);
  if (!failure.empty()) return;
  visit_scores(visitor);
}

void BenchmarkOutcome::visit_scores(ResultVisitor& visitor) {
  visitor({.key = "right"}, success);
  visitor.word({.key = "stop"}, stop, StopReason::kNoProgress);
  visitor({.key = "evaluations"}, evaluations);
  visitor({.key = "objective_initial"}, initial_value);
  visitor({.key = "objective"}, value);
  visitor({.key = "objective_at_truth"}, truth_value);
  visitor({.key = "initial_error", .shown = ResultVisitor::kInJson}, initial_error);
  visitor({.key = "frequency_error"}, frequency_error);
  visitor({.key = "frequency_rms_error"}, frequency_rms_error);
  visitor({.key = "frequency_bound"}, frequency_bound);
  visitor({.key = "bound_ratio", .shown = ResultVisitor::kInTables}, bound_ratio());
  visitor({.key = "contact_error", .unit = "m"}, contact_error);
  visitor({.key = "correlation"}, correlation);
  visitor({.key = "trace"}, trace);
}

std::string reason_of(const BenchmarkOutcome& outcome) {
  if (outcome.success) return {};
  if (!outcome.failure.empty()) return "refused or broke: " + outcome.failure;
  if (outcome.stop == StopReason::kNotFinite) return "met a value that is not finite";
  if (outcome.value > outcome.truth_value) {
    const bool cut =
        outcome.stop == StopReason::kEvaluationBudget || outcome.stop == StopReason::kTimeBudget;
    return cut ? "was cut by the budget before it reached the value at the truth"
               : "ended in a minimum above the value at the truth";
  }
  return "found a value below that at the truth: the objective's minimum lies elsewhere";
}

FrequencyBounds::Bounds FrequencyBounds::of(const CalibrateOptions& options, TruthCache& truths) {
  const ParameterOptions& parameters = options.calibration.parameters;
  const bool searched = parameters.law || !parameters.no_frequency();
  if (!searched || options.inversion.observation.measurement.noise_level <= 0.0) return nullptr;
  return known_.get(key_of(options), [&] {
    return std::make_shared<const std::vector<double>>(bounds_of(options, truths));
  });
}

double rms_bound(const FrequencyBounds::Bounds& bounds, const std::vector<std::size_t>& modes) {
  if (bounds == nullptr || modes.empty()) return std::numeric_limits<double>::quiet_NaN();
  double sum = 0.0;
  for (const std::size_t n : modes) sum += (*bounds)[n - 1] * (*bounds)[n - 1];
  return std::sqrt(sum / static_cast<double>(modes.size()));
}

}  // namespace modcal
