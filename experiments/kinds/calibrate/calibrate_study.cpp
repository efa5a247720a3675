#include <algorithm>

#include "experiments/kinds/calibrate/calibrate.hpp"
#include "experiments/report/result.hpp"

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
  const UnknownsOptions& unknowns = calibration.parameters.unknowns;
  if (!calibration.by_schedule() || !unknowns.fixed.empty() || !unknowns.priors.empty()) return;
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

// Objectives over their candidates and errors of the frequencies, as asked for.
void add_search_figures(const std::vector<FigureOptions>& figures,
                        const CalibrationOutcome& outcome, StudyResult& result) {
  for (const FigureOptions& figure : figures) {
    report::Figure drawn;
    if (figure.content == "objectives") {
      drawn = objective_figure(figure, outcome);
    } else if (figure.content == "frequency_errors") {
      drawn = frequency_error_figure(figure, outcome);
    } else {
      continue;
    }
    if (drawn.panels.empty()) continue;  // only a systematic search has candidates to draw
    result.blocks.emplace_back(std::move(drawn));
  }
}

// What a calibration and the identification with its model found.
struct Found {
  const CalibrationOutcome& outcome;
  const Observation& measured;     // as recorded
  const Observation& observation;  // the sensors' differences taken out
  const Sensor& sensors;
  const std::vector<SideIdentification>& sides;
  const ContinuationResult* estimate() const { return outcome.result.continuation.get(); }
};

void note(StudyResult& result, const std::string& text,
          report::Text::Kind kind = report::Text::Kind::kNote) {
  if (!text.empty()) result.blocks.emplace_back(report::Text{text, kind});
}

// What was asked: the verdict, the parameters, the frequencies against their law, the force.
void add_answer(const CalibrateOptions& options, const InvertOptions& shown, const Found& found,
                StudyResult& result) {
  add_calibration_summary(found.outcome, result);
  add_calibration_warnings(found.outcome, result);
  if (const ContinuationResult* estimate = found.estimate()) {
    note(result, chi2_text(*estimate),
         estimate->fits ? report::Text::Kind::kNote : report::Text::Kind::kFailure);
  }
  result.add(report::tables_of(
      [&found](ResultVisitor& visitor) { found.outcome.visit_parameters(visitor); }));
  if (shown.overview) {
    add_calibration_overview(
        found.outcome, found.observation,
        options.calibration.support.support(found.observation.truth == nullptr), result);
  }
  add_identification_figures(shown, found.observation, found.sides, result);
  if (options.audio) {
    result.blocks.emplace_back(
        calibration_audio(options, found.observation, found.outcome.refined));
  }
}

// How it was found, and all numbers.
void add_account(const CalibrateOptions& options, const InvertOptions& shown, const Found& found,
                 StudyResult& result) {
  add_search_figures(shown.figures, found.outcome, result);
  const ContinuationResult* estimate = found.estimate();
  if (estimate) {
    note(result, cause_lines(found.outcome.result));
    report::Figure misfit = misfit_figure(*estimate);
    if (!misfit.panels.empty()) result.blocks.emplace_back(std::move(misfit));
  }
  for (const std::string& text : {found.measured.modes_taken, found.outcome.start,
                                  default_text(options.calibration, found.measured),
                                  correction_text(found.measured, found.sensors)}) {
    if (!text.empty()) result.summary += text + "\n";
    note(result, text);
  }
  add_warnings(found.observation, found.sides, result);
  result.summary += score_lines(found.sides);
  if (estimate) result.summary += covariance_text(*estimate);
  result.add(report::tables_of(found.outcome));
  result.add({identification_table(found.sides)});
  result.files.emplace_back("calibration.json", report::json_file(report::json_of(found.outcome)));
  if (shown.write_signals) {
    result.signal_files.push_back(identified_signals(found.observation, found.sides));
  }
}

}  // namespace

void CalibrateOptions::visit(OptionVisitor& visitor) {
  inversion.visit(visitor);
  visitor("calibration", "what is refined, by which objective and optimizer", calibration);
  visitor("further_strokes", "strokes of the same string that are fitted together with the first",
          further);
  visitor("plucks", "plucks of the same string that are fitted together with the strokes", plucks);
  visitor("fill_blind_modes",
          "give blind modes the frequencies of the stiff-string law fitted to the "
          "others",
          fill_blind_modes);
  visitor("audio",
          "players in the report for the true, one-sided and joint force and string "
          "velocity",
          audio);
}

std::vector<double> frequencies_of(const ModalBasis& basis) {
  std::vector<double> frequencies(basis.size());
  for (std::size_t n = 0; n < basis.size(); ++n) frequencies[n] = basis.frequency(n);
  return frequencies;
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
  outcome.initial =
      with_errors(observation.basis, observation.contact, options.inversion.model_error,
                  options.inversion.key().with("model error"));
  start_from_record(observation, options.calibration, outcome);
  std::vector<CalibrationRecord> records;
  for (const Observation& stroke : strokes) {
    records.push_back({.data = calibration_data(stroke), .recorded = stroke.truth == nullptr});
  }
  records.insert(records.end(), plucks.begin(), plucks.end());
  outcome.result = calibrate({outcome.initial.basis, outcome.initial.contact}, std::move(records),
                             options.calibration, std::move(clock));
  outcome.refined = {outcome.result.model.basis, outcome.result.model.contact};
  if (observation.truth) {
    outcome.true_frequencies = frequencies_of(observation.basis);
  } else {
    follow_tension(observation, outcome);
  }
  if (options.fill_blind_modes) fill_blind(outcome);
  return outcome;
}

StudyResult CalibrateOptions::run(const StudyContext& context) const {
  const InvertOptions shown = inversion.as_read_by(context);
  OutputRequest outputs = truth_outputs(shown.figures, shown.overview);
  if (audio) outputs.velocity = true;
  const Observation measured =
      observe(inversion.observation, outputs, context.work.truths, inversion.key(), context.folder);
  further.require_fit_to(inversion.observation, calibration);
  require_agreement(calibration, *inversion.inversion.estimator.make(),
                    inversion.observation.has_record);
  std::vector<Observation> strokes = further_observations(*this, context);
  strokes.insert(strokes.begin(), measured);
  require_plucks(plucks, inversion.observation, calibration);
  const CalibrationOutcome outcome =
      calibrate_strokes(*this, strokes, polling_clock(context),
                        observe_plucks(plucks, inversion.observation, inversion.key(), context));
  context.throw_if_interrupted();
  const Sensor sensors = told_sensors(outcome.result);
  const Observation observation = with_sensors_alike(measured, sensors);
  const auto sides =
      identify(observation, outcome.refined, inversion.inversion,
               inversion_outputs(shown.figures, shown.wants_all()), &inversion.score);

  StudyResult result;
  const Found found{outcome, measured, observation, sensors, sides};
  add_answer(*this, shown, found, result);
  add_account(*this, shown, found, result);
  return result;
}

}  // namespace modcal
