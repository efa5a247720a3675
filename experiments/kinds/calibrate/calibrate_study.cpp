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

}  // namespace

void FurtherStrokes::visit(OptionVisitor& visitor) {
  visitor("contacts", "contact points x_c of further simulated strokes",
          {.unit = "m", .range = Range::positive()}, contacts);
  visitor("records",
          "further recorded files with the channels of the first; each stroke's "
          "contact point is found by itself, started from the bow's",
          files);
}

void FurtherStrokes::require_fit_to(const ObservationOptions& first,
                                    const CalibrationOptions& calibration) const {
  if (contacts.empty() && files.empty()) return;
  MODCAL_REQUIRE(calibration.by_schedule(),
                 "{} further strokes are fitted together by the joint likelihood alone: state "
                 "objective: joint_likelihood, optimizer: staged",
                 contacts.size() + files.size());
  MODCAL_REQUIRE(contacts.empty() || first.has_scene,
                 "{} further contacts are simulated, but there is no scene: name further records",
                 contacts.size());
  MODCAL_REQUIRE(files.empty() || first.has_record,
                 "{} further records go with a first one: state record, or name further contacts",
                 files.size());
  const double length = first.string_model().length;
  for (const double contact : contacts) {
    MODCAL_REQUIRE(contact < length, "contact at {} m is not on the string of {} m", contact,
                   length);
  }
}

void CalibrateOptions::visit(OptionVisitor& visitor) {
  inversion.visit(visitor);
  visitor("calibration", "what is refined, by which objective and optimizer", {.required = true},
          calibration);
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
  OutputRequest outputs = truth_outputs(inversion.figures);
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
               inversion_outputs(inversion.figures, inversion.write_signals), &inversion.score);

  StudyResult result;
  add_calibration_summary(outcome, result);
  add_calibration_warnings(outcome, result);
  for (const std::string& text : {measured.modes_taken, default_text(calibration, measured),
                                  correction_text(measured, sensors)}) {
    if (text.empty()) continue;
    result.summary += text + "\n";
    result.blocks.emplace_back(report::Text{text, report::Text::Kind::kNote});
  }
  if (const auto& found = outcome.result.continuation) {
    result.blocks.emplace_back(report::Text{
        chi2_text(*found), found->fits ? report::Text::Kind::kNote : report::Text::Kind::kFailure});
  }
  add_warnings(observation, sides, result);
  add_search_figures(inversion.figures, outcome, result);
  if (outcome.result.continuation) {
    report::Figure misfit = misfit_figure(*outcome.result.continuation);
    const std::string causes = cause_lines(outcome.result);
    if (!causes.empty())
      result.blocks.emplace_back(report::Text{causes, report::Text::Kind::kNote});
    if (!misfit.panels.empty()) result.blocks.emplace_back(std::move(misfit));
  }
  add_identification_figures(inversion.figures, observation, sides, result);
  if (audio) {
    result.blocks.emplace_back(calibration_audio(*this, observation, outcome.refined));
  }
  if (const auto& found = outcome.result.continuation) {
    result.summary += covariance_text(*found);
  }
  result.add(report::tables_of(outcome));
  result.add({identification_table(sides)});
  result.files.emplace_back("calibration.json", report::json_file(report::json_of(outcome)));
  if (inversion.write_signals) {
    result.signal_files.push_back(identified_signals(observation, sides));
  }
  return result;
}

}  // namespace modcal
