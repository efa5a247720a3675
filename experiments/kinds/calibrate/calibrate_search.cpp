// The search of a calibration: its records, its initial model, what it finds.
#include <algorithm>

#include "experiments/kinds/calibrate/calibrate_force.hpp"
#include "libcalib/objectives/joint_likelihood.hpp"
#include "libcalib/objectives/posterior.hpp"
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
  double fundamental = 0.0;
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
  const double contact = told->rival ? outcome.initial.contact : told->contact * basis.length;
  outcome.start = fmt::format(
      "Started from the string that the ends of the record tell: f0 {:.6g} Hz, B {}, x_c "
      "{:.4g} mm.",
      told->fundamental, inharmonicity_text(told->inharmonicity), 1e3 * contact);
  outcome.contact_untold = told->rival && calibration.parameters.contact;
  if (told->rival) {
    outcome.start += fmt::format(
        " The ends do not tell x_c, as of a pluck or of what rings by itself: it starts as stated, "
        "and with {:.4g} mm they would be explained as well.",
        1e3 * *told->rival * basis.length);
  }
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

void require_told_string(const ObservationOptions& first, std::span<const Observation> strokes) {
  if (!std::ranges::all_of(strokes, &Observation::is_one_signal)) return;
  throw WrongKey(
      "bow.position",
      fmt::format("{}: both reactions are one signal, as those of a string with the contact in its "
                  "middle are whatever f0, B and damping: nothing can be calibrated from them. "
                  "Record a stroke 2 % of the length or more off the middle, or, where the contact "
                  "was elsewhere, give each end a sensor and a channel of its own",
                  first.record.file));
}

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
  require_different_strokes(observed.strokes);
  require_plucks(options.plucks, inversion.observation, options.calibration);
  observed.plucks = observe_plucks(options.plucks, inversion.observation, inversion.key(), context);
  if (observed.plucks.empty()) require_told_string(inversion.observation, observed.strokes);
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
  outcome.refined = {outcome.result.model.basis, outcome.result.model.contact,
                     options.calibration.support.bending()};
  if (observation.truth) {
    outcome.true_frequencies = frequencies_of(observation.basis);
  } else {
    follow_tension(observation, outcome);
  }
  if (options.fill_blind_modes) fill_blind(outcome);
  return outcome;
}

namespace {

// Where the model of the free parameters is right. contacts: x_c of every stroke [m].
std::vector<double> truth_of(const ParameterSet& parameters, const ModelPoint& truth,
                             const std::vector<double>& contacts) {
  std::vector<double> x;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const ParameterName& name = parameters[i];
    if (name.kind == ParameterKind::kContact) {
      x.push_back(contacts[name.record]);
    } else if (name.kind == ParameterKind::kDampingFactor) {
      // A model error is one factor of all ζ_n.
      x.push_back(truth.basis.zeta[0] / parameters.initial().basis.zeta[0]);
    } else {
      x.push_back(value_of(name, truth));
    }
  }
  return x;
}

// Of a simulated string. Noise that is not there leaves no records.
Problem clean_problem(const CalibrateOptions& options, const Problem& problem,
                      const StudyContext& context) {
  const LimitQuestion question = options.limit_question();
  Problem clean{.model = {}, .records = {}, .parameters = problem.parameters, .objective = {}};
  JointLikelihood::Options likelihood;
  likelihood.highest_frequency = question.highest_frequency;
  clean.objective = std::make_shared<JointLikelihood>(likelihood);
  if (!(question.noise_level > 0.0)) return clean;
  const LimitCase records = limit_case(question, context.work.truths);
  clean.model = records.truth;
  const auto add = [&clean](const NoisyRecords& record, bool pluck) {
    clean.records.push_back({.data = CalibrationData::of_records(
                                 record.reactions[0], record.reactions[1], record.sample_rate),
                             .noise = record.deviation,
                             .pluck = pluck});
  };
  for (const NoisyRecords& stroke : records.strokes) add(stroke, false);
  for (const NoisyRecords& pluck : records.plucks) add(pluck, true);
  return clean;
}

}  // namespace

std::vector<double> SearchTask::bound_deviations() const {
  if (!clean) return {};
  if (clean->records.empty()) return std::vector<double>(truth.size(), 0.0);
  std::vector<std::string> names;
  std::vector<double> x = truth, units(truth.size(), 1.0);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Parameter& parameter = bound.parameters[i];
    names.push_back(parameter.variable.name);
    // The factor of the true damping is 1.
    if (parameter.kind == ParameterKind::kDampingFactor) std::swap(x[i], units[i]);
  }
  std::vector<HeldParameter> held = bound.held;
  for (HeldParameter& one : held) {
    if (one.record == 0) one.value = value_of(one, clean->model);
  }
  const ParameterSet parameters(clean->model, names, clean->parameters.ranges,
                                clean->records.size(), held);
  std::shared_ptr<const ObjectiveFunction> function = clean->objective->bind(*clean, parameters);
  if (optimizer->needs().schedule) {
    function = with_priors(std::move(function), *clean, parameters, LimitQuestion::kLawWidth);
  }
  std::vector<double> deviations = deviations_by_information(*function, x);
  for (std::size_t i = 0; i < x.size(); ++i) deviations[i] *= units[i];
  return deviations;
}

std::unique_ptr<const SearchTask> CalibrateOptions::search_task(const StudyContext& context) const {
  MODCAL_REQUIRE(!has_structure,
                 "the modes of a structure are searched by one Newton search of its own, which "
                 "takes no other optimizer: run the file");
  const ObservedRecords observed =
      observe_records(*this, {.left_reaction = true, .right_reaction = true}, context);
  CalibrationOutcome outcome;
  const Problem problem = begin_calibration(*this, observed.strokes, observed.plucks, outcome);
  calibration.require_read(observed.strokes.size(), observed.plucks.size());
  auto optimizer = calibration.optimizer.make();
  auto task = std::make_unique<SearchTask>(
      SearchTask{bind(problem, *optimizer), optimizer, calibration.budget, {}, {}});
  BoundProblem& bound = task->bound;
  if (optimizer->needs().schedule) {
    bound.function = with_priors(std::move(bound.function), bound.problem, bound.parameters,
                                 LimitQuestion::kLawWidth);
  }
  if (const auto& truth = observed.strokes.front().truth) {
    std::vector<double> contacts;
    for (const Observation& stroke : observed.strokes) contacts.push_back(stroke.contact);
    task->truth = truth_of(bound.parameters, {truth->basis, truth->contact}, contacts);
    task->clean = clean_problem(*this, bound.problem, context);
  }
  return task;
}

}  // namespace modcal
