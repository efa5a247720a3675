// The search of a calibration: its records, its initial model, what it finds.
#include <algorithm>

#include "experiments/kinds/calibrate/calibrate.hpp"
#include "libcalib/problem/covariance.hpp"

namespace modcal {
namespace {

// 1 of an excited mode, 0 of a blind one.
std::vector<double> excitation(const CalibrationOutcome& outcome) {
  std::vector<double> weights;
  for (const CalibratedMode& mode : outcome.result.modes) {
    weights.push_back(mode.excited ? 1.0 : 0.0);
  }
  return weights;
}

void fill_blind(CalibrationOutcome& outcome) {
  const std::vector<double> weights = excitation(outcome);
  const std::vector<double> refined = frequencies_of(outcome.refined.basis);
  outcome.law = fit_stiff_string(refined, weights);
  outcome.refined.basis = with_frequencies(
      outcome.refined.basis,
      fill_unexcited_modes(refined, {weights.begin(), weights.end()}, *outcome.law));
}

// T = 4 L² f₀² ρ_L: what is stated of a recorded string gives ρ_L and L, the f₀ found the tension.
void follow_tension(const Observation& observation, CalibrationOutcome& outcome) {
  double fundamental = observation.fundamental;
  if (const auto& found = outcome.result.continuation) {
    fundamental = found->found_law.fundamental;
  } else {
    const std::vector<double> weights = excitation(outcome);
    if (std::count(weights.begin(), weights.end(), 1.0) < 2) return;
    fundamental = fit_stiff_string(frequencies_of(outcome.refined.basis), weights).fundamental;
  }
  const double ratio = fundamental / observation.fundamental;
  outcome.refined.basis.tension *= ratio * ratio;
}

// The string that the ends of a record tell, unless what is stated of it is more than a start: from
// B = 0, where it is 1e-4, the thirtieth mode starts nearer to the next one than to itself, and
// ends there.
void start_from_record(const Observation& observation, const CalibrationOptions& calibration,
                       CalibrationOutcome& outcome) {
  if (!starts_from_record(calibration)) return;
  const auto told = told_string(observation);
  if (!told) return;
  ModalBasis& basis = outcome.initial.basis;
  std::vector<double> frequencies;
  for (std::size_t n = 1; n <= basis.size(); ++n) {
    frequencies.push_back(stiff_string_frequency(told->fundamental, told->inharmonicity, n));
  }
  const double contact = told->contact * basis.length;
  outcome.start = fmt::format(
      "Started from the string that the ends of the record tell: f0 {:.6g} Hz, B {}, x_c "
      "{:.4g} mm.",
      told->fundamental, inharmonicity_text(told->inharmonicity), 1e3 * contact);
  const double stated = basis.frequency(0);
  if (std::abs(frequencies[0] / stated - 1.0) > 0.03 ||
      std::abs(contact - outcome.initial.contact) > 0.02 * basis.length) {
    outcome.start += fmt::format(
        " That is far from the f_1 {:.6g} Hz and x_c {:.4g} mm stated: check which are right.",
        stated, 1e3 * outcome.initial.contact);
  }
  basis = with_frequencies(std::move(basis), frequencies);
  if (calibration.parameters.contact) outcome.initial.contact = contact;
}

// What is searched; the initial model goes into the outcome.
Problem begin_calibration(const CalibrateOptions& options, std::span<const Observation> strokes,
                          std::span<const CalibrationRecord> plucks, CalibrationOutcome& outcome) {
  const Observation& observation = strokes.front();
  outcome.initial =
      with_errors(observation.basis, observation.contact, options.inversion.model_error,
                  options.inversion.key().with("model error"));
  start_from_record(observation, options.calibration, outcome);
  std::vector<CalibrationRecord> records;
  for (const Observation& stroke : strokes) {
    records.push_back({.data = calibration_data(stroke), .recorded = stroke.truth == nullptr});
  }
  records.insert(records.end(), plucks.begin(), plucks.end());
  return options.calibration.problem({outcome.initial.basis, outcome.initial.contact},
                                     std::move(records));
}

// Strokes after the first: the same scene bowed elsewhere, or other files; noise of their own.
std::vector<Observation> further_observations(const CalibrateOptions& options,
                                              const StudyContext& context) {
  std::vector<Observation> strokes;
  const OutputRequest reactions{.left_reaction = true, .right_reaction = true};
  const auto add = [&](const ObservationOptions& stroke) {
    context.throw_if_interrupted();
    const StreamKey key =
        options.inversion.key().with("stroke").with(static_cast<std::uint64_t>(strokes.size() + 2));
    strokes.push_back(observe(stroke, reactions, context.work.truths, key, context.folder));
  };
  for (const double contact : options.further.contacts) {
    ObservationOptions stroke = options.inversion.observation;
    stroke.truth.scene.bow.position = contact;
    add(stroke);
  }
  for (const std::string& file : options.further.files) {
    ObservationOptions stroke = options.inversion.observation;
    stroke.record.file = file;
    add(stroke);
  }
  return strokes;
}

}  // namespace

ObservedRecords observe_records(const CalibrateOptions& options, const OutputRequest& outputs,
                                const StudyContext& context) {
  const InvertOptions& inversion = options.inversion;
  const Observation first =
      observe(inversion.observation, outputs, context.work.truths, inversion.key(), context.folder);
  options.further.require_fit_to(inversion.observation, options.calibration);
  require_agreement(options.calibration, *inversion.inversion.estimator.make(),
                    inversion.observation.has_record);
  ObservedRecords observed{further_observations(options, context), {}};
  observed.strokes.insert(observed.strokes.begin(), first);
  require_plucks(options.plucks, inversion.observation, options.calibration);
  observed.plucks = observe_plucks(options.plucks, inversion.observation, inversion.key(), context);
  return observed;
}

bool starts_from_record(const CalibrationOptions& calibration) {
  const UnknownsOptions& unknowns = calibration.parameters.unknowns;
  return calibration.by_schedule() && unknowns.fixed.empty() && unknowns.priors.empty();
}

CalibrationData calibration_data(const Observation& observation) {
  const auto samples = [&observation](End end) -> std::span<const double> {
    const auto& reaction = observation.reaction(end);
    return reaction ? std::span<const double>(reaction->samples) : std::span<const double>();
  };
  return CalibrationData::of_records(samples(End::kLeft), samples(End::kRight),
                                     observation.sample_rate);
}

SecondsClock polling_clock(const StudyContext& context) {
  return [&context, clock = steady_seconds()] {
    context.throw_if_interrupted();
    return clock();
  };
}

CalibrationOutcome calibrate_observation(const CalibrateOptions& options,
                                         const Observation& observation, SecondsClock clock) {
  return calibrate_strokes(options, std::span(&observation, 1), std::move(clock));
}

CalibrationOutcome calibrate_strokes(const CalibrateOptions& options,
                                     std::span<const Observation> strokes, SecondsClock clock,
                                     std::span<const CalibrationRecord> plucks) {
  const Observation& observation = strokes.front();
  CalibrationOutcome outcome;
  Problem problem = begin_calibration(options, strokes, plucks, outcome);
  outcome.result =
      calibrate(problem.model, std::move(problem.records), options.calibration, std::move(clock));
  outcome.refined = {outcome.result.model.basis, outcome.result.model.contact};
  if (observation.truth) {
    outcome.true_frequencies = frequencies_of(observation.basis);
  } else {
    follow_tension(observation, outcome);
  }
  if (options.fill_blind_modes) fill_blind(outcome);
  return outcome;
}

std::vector<double> SearchTask::bound_deviations() const {
  const Problem& problem = bound.problem;
  if (truth.empty() || !problem.objective->whitened()) return {};
  const Covariance covariance = covariance_at(*bound.function, bound.parameters.variables(), truth);
  std::vector<double> deviations;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    deviations.push_back(covariance.standard_deviation(i));
  }
  return deviations;
}

std::unique_ptr<const SearchTask> CalibrateOptions::search_task(const StudyContext& context) const {
  const ObservedRecords observed =
      observe_records(*this, {.left_reaction = true, .right_reaction = true}, context);
  CalibrationOutcome outcome;
  const Problem problem = begin_calibration(*this, observed.strokes, observed.plucks, outcome);
  auto optimizer = calibration.optimizer.make();
  auto task = std::make_unique<SearchTask>(
      SearchTask{bind(problem, *optimizer), optimizer, calibration.budget, {}});
  if (const auto& truth = observed.strokes.front().truth) {
    std::vector<std::string> names;
    for (const Variable& variable : task->bound.parameters.variables()) {
      names.push_back(variable.name);
    }
    task->truth = ParameterSet({truth->basis, truth->contact}, names).start();
  }
  return task;
}

}  // namespace modcal
