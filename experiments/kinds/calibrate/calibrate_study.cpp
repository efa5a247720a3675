#include <algorithm>
#include <optional>

#include "experiments/kinds/calibrate/calibrate_force.hpp"
#include "experiments/kinds/calibrate/calibrate_searches.hpp"
#include "experiments/report/result.hpp"
#include "libcalib/identifiability/tuning.hpp"
#include "libinverse/joint/tuning.hpp"

namespace modcal {
namespace {

// Objectives over their candidates and errors of the frequencies, as asked for.
void add_search_figures(const std::vector<FigureOptions>& figures,
                        const CalibrationOutcome& outcome, StudyResult& result) {
  for (const FigureOptions& figure : figures) {
    report::Figure drawn;
    if (figure.drawn() == FigureContent::kObjectives) {
      drawn = objective_figure(figure, outcome);
    } else if (figure.drawn() == FigureContent::kFrequencyErrors) {
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
  double ringing_misfit;
  std::string another_contact;
  const ContinuationResult* estimate() const { return outcome.result.continuation.get(); }
};

void note(StudyResult& result, const std::string& text,
          report::Text::Kind kind = report::Text::Kind::kNote) {
  if (!text.empty()) result.blocks.emplace_back(report::Text{text, kind});
}

// Of a record of which more modes are stated than it tells by half.
std::string too_many_modes(const Found& found) {
  const std::size_t stated = found.measured.basis.size();
  const bool is_stated = found.measured.truth == nullptr && found.measured.modes_taken.empty();
  const auto identified = highest_identified(found.outcome);
  if (!is_stated || !identified || 2 * stated <= 3 * modes_told(*identified)) return {};
  return fmt::format(
      "{} modes are stated, and none above mode {} is identified: they have many places in the "
      "noise, and f0, B and x_c may be those of another minimum; state modes: auto, or {}",
      stated, *identified, modes_told(*identified));
}

// Of a record that tells hardly a mode, where nothing else holds the string: f0 and x_c have many
// places in its noise.
std::string too_few_modes(const CalibrateOptions& options, const Found& found) {
  const ContinuationResult* estimate = found.estimate();
  const bool is_open = found.measured.truth == nullptr && starts_from_record(options.calibration);
  if (!is_open || !estimate || !estimate->frequencies_free) return {};
  const auto identified =
      std::ranges::count(estimate->modes, ModeSource::kIdentified, &ModeVerdict::source);
  // An x_c that is held is one thing more that is known; one that is found elsewhere than stated
  // contradicts one.
  const double beside = std::abs(found.outcome.refined.contact - found.measured.contact);
  const int more = !options.calibration.parameters.contact                ? -1
                   : beside > kContactShift * found.measured.basis.length ? 1
                                                                          : 0;
  if (identified >= kLeastIdentified + more) return {};
  return fmt::format(
      "the record tells {} of its modes, too few for a string of which nothing else is known: f0, "
      "B and x_c may be those of another minimum; record for longer, with less noise or while the "
      "string sounds, or state priors (calibration.parameters.priors)",
      identified == 0 ? "none" : fmt::format("{}", identified));
}

// Of a record in which nothing drives the string: what tells x_c is the force.
std::string no_force(const Found& found) {
  const double misfit = found.ringing_misfit;
  if (!(misfit > kLeastRinging && misfit < kRingsByItself)) return {};
  return fmt::format(
      "nothing drives the string in this record: it rings by itself (free decays leave {:.3g} "
      "times the noise of it), which does not tell x_c; kind: identify finds its modes, or take a "
      "part in which a bow, a finger or a hammer is at work",
      misfit);
}

// What was asked: the verdict, the parameters, the frequencies against their law, the force.
void add_answer(const CalibrateOptions& options, const InvertOptions& shown, const Found& found,
                StudyResult& result) {
  add_calibration_summary(found.outcome, result);
  add_calibration_warnings(found.outcome, result);
  for (const std::string& reason : {too_many_modes(found), no_force(found),
                                    too_few_modes(options, found), found.another_contact}) {
    if (!reason.empty()) reject_calibration(reason, result);
  }
  if (const ContinuationResult* estimate = found.estimate()) {
    note(result, chi2_text(*estimate),
         estimate->fits ? report::Text::Kind::kNote : report::Text::Kind::kFailure);
  }
  if (result.answer.empty()) result.answer = calibration_answer(found.outcome);
  add_warnings(found.observation, found.sides, true, result);
  std::vector<report::Figure> overview;
  std::vector<report::Figure> force;
  if (shown.overview) {
    overview = calibration_overview(
        found.outcome, found.observation,
        options.calibration.support.support(found.observation.truth == nullptr));
    force = overview_figures(found.observation, found.sides);
  }
  const auto add_figures = [&result](auto from, auto to) {
    std::move(from, to, std::back_inserter(result.blocks));
  };
  const auto first = [](std::vector<report::Figure>& figures) {
    return figures.begin() + (figures.empty() ? 0 : 1);
  };
  add_figures(overview.begin(), first(overview));
  add_figures(force.begin(), first(force));
  result.add(parameter_tables(found.outcome));
  result.end_first_screen();
  add_figures(first(overview), overview.end());
  add_figures(first(force), force.end());
  add_identification_figures(shown.figures, found.observation, found.sides, result);
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
  for (const std::string& text :
       {found.outcome.start, default_text(options.calibration, found.measured),
        correction_text(found.measured, found.sensors)}) {
    if (!text.empty()) result.summary += text + "\n";
    note(result, text);
  }
  add_notes(found.observation, found.sides, result);
  add_scores(found.sides, result);
  if (estimate) result.summary += covariance_text(*estimate);
  if (estimate) {
    report::Table map = correlation_map(*estimate);
    if (map.rows.size() > 1) result.blocks.emplace_back(std::move(map));
  }
  result.add(report::tables_of(found.outcome));
  add_identification_tables(found.sides, result);
  result.files.emplace_back("calibration.json", report::json_file(report::json_of(found.outcome)));
  if (shown.writes()) {
    shown.add_signals(identified_signals(found.observation, found.sides), result);
  }
}

}  // namespace

void CalibrateOptions::visit(OptionVisitor& visitor) {
  inversion.visit(visitor);
  visitor("structure",
          "any structure, in the place of a string: a table of modes that responses refine, their "
          "force unknown",
          has_structure, structure);
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

StudyResult CalibrateOptions::run(const StudyContext& context) const {
  if (has_structure) return structure.run(context, inversion.seed);
  const InvertOptions shown = inversion.as_read_by(context);
  OutputRequest outputs = truth_outputs(shown.figures, shown.overview);
  if (audio) outputs.velocity = true;
  ObservedRecords observed = observe_records(*this, outputs, context);
  CalibrationOutcome outcome = calibrate_as_told(*this, observed, context);
  const Observation& measured = observed.strokes.front();
  context.throw_if_interrupted();
  const CalibratedForce force = identify_calibrated(
      *this, measured, outcome, inversion_outputs(shown.figures, shown.wants_all()), context.stop);

  StudyResult result;
  const std::string another = another_contact(*this, observed, context, outcome);
  const Found found{outcome,       measured,    force.observation,
                    force.sensors, force.sides, force.ringing_misfit,
                    another};
  add_answer(*this, shown, found, result);
  add_account(*this, shown, found, result);
  return result;
}

}  // namespace modcal
