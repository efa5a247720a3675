#include "experiments/kinds/calibrate/calibrate_experiment.hpp"

#include <algorithm>
#include <cmath>

#include "experiments/kinds/calibrate/calibrate_study.hpp"
#include "experiments/kinds/invert/invert_study.hpp"
#include "experiments/kinds/lint.hpp"

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
  lint_making(findings, "inversion.estimator",
              [&] { require_sensors_once(options.calibration, *estimator); });
}

// Whether a simulated record shows the noise levels that are not stated; a file is not read here.
void lint_noise(const CalibrateOptions& options, std::vector<Finding>& findings) {
  const ObservationOptions& observation = options.inversion.observation;
  const bool known = std::none_of(findings.begin(), findings.end(),
                                  [](const Finding& finding) { return finding.is_error; });
  if (!known || !observation.has_scene || !is_known(observation.string_model())) return;
  const CalibrationOptions& calibration = options.calibration;
  const double rate = observation.measurement.sample_rate;
  const auto samples =
      static_cast<std::size_t>(std::round(observation.truth.scene.duration * rate));
  lint_making(findings, "calibration.objective", [&] {
    calibration.objective.make()->require_record(make_modal_basis(observation.string_model()), rate,
                                                 samples);
  });
}

// Whether the optimizer can minimize the objective, where both can be made at all.
void lint_pairing(const CalibrationOptions& calibration, std::vector<Finding>& findings) {
  const auto stands = [&findings](std::string_view path) {
    return std::any_of(findings.begin(), findings.end(),
                       [path](const Finding& finding) { return finding.path.starts_with(path); });
  };
  if (stands("calibration.objective") || stands("calibration.optimizer")) return;
  lint_making(findings, "calibration.optimizer", [&] {
    const std::string mismatch = calibration.optimizer.make()->explain_unsatisfied(
        calibration.objective.selected(), calibration.objective.make()->capabilities());
    MODCAL_REQUIRE(mismatch.empty(), "{}", mismatch);
  });
}

}  // namespace

std::vector<Finding> CalibrateExperiment::lint() const {
  std::vector<Finding> findings = lint_inversion(options_.inversion);
  lint_sensors(options_, findings);
  const auto refuse = [&findings](bool stated, const char* key) {
    if (!stated) return;
    add_finding(findings, key,
                "a calibration identifies the force by inversion.estimator and does not read {0}: "
                "leave it out, or state {0} in an experiment of kind: invert",
                key);
  };
  refuse(options_.inversion.wave_based, "wave_based");
  refuse(options_.inversion.has_model_based, "model_based");
  append(findings,
         lint_figures(options_.inversion.figures, {"waveforms", "spectra", "parameter_curves",
                                                   "objectives", "frequency_errors"}));
  const CalibrationOptions& calibration = options_.calibration;
  lint_making(findings, "calibration.objective", [&] { calibration.objective.make(); });
  lint_making(findings, "calibration.optimizer", [&] { calibration.optimizer.make(); });
  lint_pairing(calibration, findings);
  lint_making(findings, "calibration.budget", [&] { calibration.budget.require_valid(); });
  lint_making(findings, "further_strokes", [&] {
    options_.further.require_fit_to(options_.inversion.observation, calibration);
  });
  append(findings, lint_plucks(options_.plucks, options_.inversion.observation, calibration));
  lint_noise(options_, findings);
  const auto modes = static_cast<std::size_t>(options_.inversion.observation.string_model().modes);
  const std::size_t strokes = 1 + options_.further.contacts.size() + options_.further.files.size();
  append(findings, lint_priors("calibration.parameters", calibration.parameters.unknowns,
                               options_.inversion.observation.string_model(),
                               strokes + options_.plucks.size()));
  lint_making(findings, "calibration.parameters", [&] {
    calibration.require_read(strokes, options_.plucks.size());
    calibration.objective.make()->require_moved_by(calibration.parameters.names(modes));
  });
  return findings;
}

std::vector<std::string> CalibrateExperiment::plan() const {
  std::vector<std::string> lines;
  const ObservationOptions& observation = options_.inversion.observation;
  const auto planned = planned_simulations();
  lines.push_back(planned ? plan_line(*planned) : "record: " + observation.record.file);
  const auto modes = static_cast<std::size_t>(observation.string_model().modes);
  const CalibrationOptions& calibration = options_.calibration;
  lines.push_back(
      fmt::format("calibration: {} parameters asked for, objective {}, optimizer {}, at "
                  "most {} evaluations",
                  calibration.parameters.names(modes).size(), calibration.objective.selected(),
                  calibration.optimizer.selected(), calibration.budget.evaluations));
  const std::size_t further = options_.further.contacts.size() + options_.further.files.size();
  if (further > 0) lines.push_back(fmt::format("strokes fitted together: {}", further + 1));
  if (!options_.plucks.empty()) {
    lines.push_back(fmt::format("plucks fitted with them: {}", options_.plucks.size()));
  }
  return lines;
}

std::optional<PlannedSimulations> CalibrateExperiment::planned_simulations() const {
  const ObservationOptions& first = options_.inversion.observation;
  auto planned = planned_truths(first, truth_outputs(options_.inversion.figures),
                                1 + options_.further.contacts.size());
  for (const PluckRecordOptions& pluck : options_.plucks) {
    if (planned && pluck.file.empty()) add_planned(pluck.observation(first), *planned);
  }
  return planned;
}

std::vector<std::string> CalibrateExperiment::files_read() const {
  std::vector<std::string> files = options_.inversion.files_read();
  files.insert(files.end(), options_.further.files.begin(), options_.further.files.end());
  for (const PluckRecordOptions& pluck : options_.plucks) {
    if (!pluck.file.empty()) files.push_back(pluck.file);
  }
  return files;
}

LimitQuestion CalibrateExperiment::limit_question() const {
  const ObservationOptions& first = options_.inversion.observation;
  LimitQuestion question{.observation = first,
                         .noise_level = first.measurement.noise_level,
                         .further_contacts = options_.further.contacts};
  question.calibrate_by(options_.calibration);
  for (const PluckRecordOptions& pluck : options_.plucks) {
    question.plucks.push_back(pluck.observation(first));
  }
  return question;
}

}  // namespace modcal
