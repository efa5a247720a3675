// What is wrong with the settings of a calibration, and what its records say against them.
#include "experiments/kinds/calibrate/calibrate_force.hpp"
#include "experiments/kinds/lint.hpp"
#include "libcalib/likelihood/records/noise_level.hpp"
#include "libcalib/likelihood/records/record_options.hpp"

namespace modcal {
namespace {

// Sensors stated to the estimator that the calibration's correction has taken out before.
void lint_sensors(const CalibrateOptions& options, std::vector<Finding>& findings) {
  std::shared_ptr<const Estimator> estimator;
  try {
    estimator = options.inversion.inversion.estimator.make();
  } catch (const InvalidInput&) {
    return;  // the inversion's finding
  }
  lint_making(findings, "inversion.estimator", [&] {
    require_agreement(options.calibration, *estimator, options.inversion.observation.has_record);
  });
}

// Whether a simulated record shows the noise levels that are not stated; a file is not read here.
void lint_noise(const CalibrateOptions& options, std::vector<Finding>& findings) {
  const ObservationOptions& observation = options.inversion.observation;
  const bool known = std::none_of(findings.begin(), findings.end(),
                                  [](const Finding& finding) { return finding.is_error; });
  if (!known || !observation.has_scene || !is_known(observation.string_model())) return;
  const CalibrationOptions& calibration = options.calibration;
  const double rate = observation.measurement.sample_rate;
  const std::size_t samples = sample_count(observation.truth.scene.duration, rate);
  lint_making(findings, "calibration.objective", [&] {
    calibration.objective.make()->require_record(make_modal_basis(observation.string_model()), rate,
                                                 samples);
  });
}

// Errors of a start that the record tells.
void lint_start(const CalibrateOptions& options, std::vector<Finding>& findings) {
  const ModelErrorOptions& errors = options.inversion.model_error;
  if (!options.inversion.observation.has_record || !starts_from_record(options.calibration)) {
    return;
  }
  const auto refuse = [&findings](bool stated, const char* key) {
    if (!stated) return;
    add_finding(findings, key,
                "the calibration of a record starts from the string that its ends tell, whatever "
                "{} says: leave it out",
                key);
  };
  refuse(errors.frequencies != 0.0, "model_error.frequencies");
  refuse(errors.contact != 0.0 && options.calibration.parameters.contact, "model_error.contact");
}

// Whether the optimizer can minimize the objective, where both can be made at all.
void lint_pairing(const CalibrationOptions& calibration, std::vector<Finding>& findings) {
  const auto stands = [&findings](std::string_view path) {
    return std::any_of(findings.begin(), findings.end(),
                       [path](const Finding& finding) { return finding.path.starts_with(path); });
  };
  if (stands("calibration.objective") || stands(kOptimizerPath)) return;
  lint_making(findings, kOptimizerPath, [&] {
    const std::string mismatch = calibration.optimizer.make()->explain_unsatisfied(
        calibration.objective.selected(), calibration.objective.make()->capabilities());
    MODCAL_REQUIRE(mismatch.empty(), "{}", mismatch);
  });
}

// Bins lie 1/T apart and the modes' lines f_0: with two bins a line there are twice as many
// residuals, four a line for two real unknowns of each decay, as unknowns.
constexpr double kLeastPeriods = 2.0;

void lint_simulated(const std::string& path, const PluckRecordOptions& pluck,
                    const StringModel& string, const Scene& scene, std::vector<Finding>& findings) {
  if (pluck.start.make()->at_rest()) {
    add_finding(findings, path + ".initial",
                "a string at rest has no free decay: pluck it (initial: {{type: pluck, "
                "...}}), or name the record of its pluck");
  }
  if (!is_known(string)) return;
  ModalBasis basis;
  try {
    basis = make_modal_basis(string);
  } catch (const InvalidInput&) {
    return;  // reported with the string
  }
  lint_making(findings, path + ".initial", [&] { initial_state(scene, basis); });
  const double top =
      *std::max_element(basis.omega.begin(), basis.omega.end()) / (2.0 * std::numbers::pi);
  if (!(pluck.sample_rate > 2.0 * top)) {
    add_finding(findings, path + ".sample_rate",
                "a pluck sampled at {:g} Hz, but the highest mode is at {:g} Hz: sample at "
                "more than twice that, or use fewer modes",
                pluck.sample_rate, top);
    return;
  }
  const double least = kLeastPeriods / basis.frequency(0);
  if (!(pluck.duration >= least)) {
    add_finding(findings, path + ".duration",
                "a pluck of {:g} s does not tell modes {:g} Hz apart from each other: record "
                "at least {:g} periods of the first mode, {:.3g} s",
                pluck.duration, basis.frequency(0), kLeastPeriods, least);
    return;
  }
  lint_making(findings, path + ".sample_rate", [&] {
    require_noise_known({pluck.left_noise, pluck.right_noise}, basis, pluck.sample_rate,
                        sample_count(pluck.duration, pluck.sample_rate));
  });
}

// What is wrong with each pluck, at its own place: plucks that do not fit to the first stroke or
// to what is calibrated, a plucking point beyond the string, a decay too short to tell its modes
// apart.
std::vector<Finding> lint_plucks(const std::vector<PluckRecordOptions>& plucks,
                                 const ObservationOptions& first,
                                 const CalibrationOptions& calibration) {
  std::vector<Finding> findings;
  if (!plucks.empty() && !calibration.by_schedule()) {
    add_finding(findings, "plucks",
                "{} plucks are fitted with the stroke by the joint likelihood "
                "alone: state objective: joint_likelihood, optimizer: staged",
                plucks.size());
  }
  for (std::size_t i = 0; i < plucks.size(); ++i) {
    const PluckRecordOptions& pluck = plucks[i];
    const std::string path = fmt::format("plucks.{}", i);
    if (!pluck.file.empty()) {
      if (first.has_record) continue;
      add_finding(findings, path + ".record",
                  "the recorded pluck {} goes with a recorded stroke: state "
                  "record, or pluck the string of the scene",
                  pluck.file);
    } else if (!first.has_scene) {
      add_finding(findings, path,
                  "{} plucks, this one simulated, but there is no scene: name its record",
                  plucks.size());
    } else {
      lint_simulated(path, pluck, first.string_model(), pluck.observation(first).truth.scene,
                     findings);
    }
  }
  return findings;
}

}  // namespace

std::vector<Finding> CalibrateOptions::lint() const {
  if (has_structure) return lint_structure();
  std::vector<Finding> findings = lint_inversion(inversion);
  lint_sensors(*this, findings);
  lint_start(*this, findings);
  const auto refuse = [&findings](bool stated, const char* key) {
    if (!stated) return;
    add_finding(findings, key,
                "a calibration identifies the force by inversion.estimator and does not read {0}: "
                "leave it out, or state {0} in an experiment of kind: invert",
                key);
  };
  refuse(inversion.wave_based, "wave_based");
  refuse(inversion.has_model_based, "model_based");
  append(findings, lint_figures(inversion.figures, FigureContent::kFrequencyErrors,
                                stated_duration(inversion.observation)));
  lint_making(findings, "calibration.objective", [&] { calibration.objective.make(); });
  lint_making(findings, kOptimizerPath, [&] { calibration.optimizer.make(); });
  lint_pairing(calibration, findings);
  lint_making(findings, "calibration.budget", [&] { calibration.budget.require_valid(); });
  lint_making(findings, "further_strokes",
              [&] { further.require_fit_to(inversion.observation, calibration); });
  append(findings, lint_plucks(plucks, inversion.observation, calibration));
  lint_noise(*this, findings);
  const StringModel string = inversion.observation.string_model().before_reading();
  const std::size_t strokes = 1 + further.contacts.size() + further.files.size();
  append(findings, lint_priors("calibration.parameters", calibration.parameters.unknowns,
                               inversion.observation.string_model(), strokes + plucks.size()));
  // How many there are, a record may have to tell.
  if (!inversion.observation.string_model().modes_of_record()) {
    for (const std::int64_t mode : calibration.parameters.modes) {
      if (mode <= string.modes) continue;
      add_finding(findings, "calibration.parameters.modes",
                  "mode {} is free, but the string has {} modes: leave it out, or raise "
                  "string.modes",
                  mode, string.modes);
    }
  }
  std::vector<std::string> names;
  lint_making(findings, "calibration.parameters", [&] {
    const UnknownsOptions& unknowns = calibration.parameters.unknowns;
    unknowns.require_found_by(calibration.optimizer.selected(), calibration.by_schedule());
    if (is_known(string)) unknowns.response.laid_out(make_modal_basis(string));
    calibration.require_read(strokes, plucks.size());
    names = calibration.parameters.names(static_cast<std::size_t>(string.modes));
  });
  lint_making(findings, "calibration.objective",
              [&] { calibration.objective.make()->require_moved_by(names); });
  return findings;
}

std::vector<Finding> CalibrateOptions::lint_records(const std::filesystem::path& folder) const {
  if (has_structure) return structure.lint_records(folder);
  std::vector<Finding> findings;
  const ObservationOptions& first = inversion.observation;
  const auto observed = lint_record("record.file", first, folder, findings);
  if (observed) {
    lint_modes(*observed, findings);
    lint_windows(inversion, *observed, findings);
    lint_making(findings, "string.modes", [&] {
      calibration.objective.make()->require_record(observed->basis, observed->sample_rate,
                                                   observed->samples());
    });
    lint_making(findings, "bow.position", [&] {
      const bool is_alone = further.files.empty() && plucks.empty();
      if (is_alone) require_told_string(first, std::span(&*observed, 1));
    });
    lint_making(findings, "calibration", [&] {
      if (calibration.by_schedule()) {
        require_both_reactions(*observed, "the joint likelihood", "calibration.objective");
      }
    });
  }
  for (std::size_t i = 0; i < further.files.size(); ++i) {
    ObservationOptions stroke = first;
    stroke.record.file = further.files[i];
    lint_record(fmt::format("further_strokes.records.{}", i), stroke, folder, findings);
  }
  for (std::size_t i = 0; i < plucks.size(); ++i) {
    if (plucks[i].file.empty()) continue;
    lint_record(fmt::format("plucks.{}.record", i), plucks[i].observation(first), folder, findings);
  }
  return findings;
}

void require_plucks(const std::vector<PluckRecordOptions>& plucks, const ObservationOptions& first,
                    const CalibrationOptions& calibration) {
  const std::vector<Finding> findings = lint_plucks(plucks, first, calibration);
  if (!findings.empty()) throw InvalidInput(findings.front().text);
}

}  // namespace modcal
