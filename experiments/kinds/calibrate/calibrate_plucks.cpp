#include "experiments/kinds/calibrate/calibrate_plucks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "experiments/kinds/calibrate/calibrate_study.hpp"
#include "experiments/kinds/lint.hpp"
#include "libcalib/likelihood/noise_level.hpp"
#include "libcalib/likelihood/record_options.hpp"
#include "libsim/base/error.hpp"

namespace modcal {

void PluckRecordOptions::visit(OptionVisitor& visitor) {
  visitor.plugin(
      {.key = "initial", .meaning = "how a simulated string is plucked; a recorded one needs none"},
      start);
  visitor.number({.key = "duration",
                  .meaning = "length of the simulated free decay",
                  .unit = "s",
                  .range = Range::positive()},
                 duration);
  visitor.number({.key = "noise_level",
                  .meaning = "standard deviation of the simulated noise, relative to that of each "
                             "reaction",
                  .unit = "1",
                  .range = Range::non_negative()},
                 noise_level);
  visitor.number({.key = "sample_rate",
                  .meaning = "sample rate of the simulated reactions",
                  .unit = "Hz",
                  .range = Range::positive()},
                 sample_rate);
  visitor.text(
      {.key = "record",
       .meaning = "a recorded file in the place of a simulated pluck, with the channels of "
                  "the stroke's; it begins when the string has been let go"},
      file);
  visit_noise_levels(visitor, left_noise, right_noise);
}

ObservationOptions PluckRecordOptions::observation(const ObservationOptions& first) const {
  ObservationOptions options = first;
  if (!file.empty()) {
    options.record.file = file;
    return options;
  }
  Scene& scene = options.truth.scene;
  scene.bow.velocity = 0.0;
  scene.bow.normal_force = 0.0;
  scene.start = start;
  scene.duration = duration;
  options.measurement.noise_level = noise_level;
  options.measurement.sample_rate = sample_rate;
  return options;
}

namespace {

// Bins lie 1/T apart and the modes' lines f_0: with two bins a line there are twice as many
// residuals, four a line for two real unknowns of each decay, as unknowns.
constexpr double kLeastPeriods = 2.0;

void lint_simulated(const std::string& path, const PluckRecordOptions& pluck,
                    const StringModel& string, const Scene& scene, std::vector<Finding>& findings) {
  if (pluck.start.selected() == "rest") {
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
                        static_cast<std::size_t>(std::round(pluck.duration * pluck.sample_rate)));
  });
}

}  // namespace

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

void require_plucks(const std::vector<PluckRecordOptions>& plucks, const ObservationOptions& first,
                    const CalibrationOptions& calibration) {
  const std::vector<Finding> findings = lint_plucks(plucks, first, calibration);
  if (!findings.empty()) throw InvalidInput(findings.front().text);
}

std::vector<CalibrationRecord> observe_plucks(const std::vector<PluckRecordOptions>& plucks,
                                              const ObservationOptions& first, const StreamKey& key,
                                              const StudyContext& context) {
  std::vector<CalibrationRecord> records;
  for (const PluckRecordOptions& pluck : plucks) {
    context.throw_if_interrupted();
    const StreamKey own = key.with("pluck").with(static_cast<std::uint64_t>(records.size() + 1));
    const Observation found =
        observe(pluck.observation(first), {.left_reaction = true, .right_reaction = true},
                context.work.truths, own, context.folder);
    records.push_back({.data = calibration_data(found),
                       .noise = {pluck.left_noise, pluck.right_noise},
                       .pluck = true});
  }
  return records;
}

}  // namespace modcal
