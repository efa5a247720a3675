#include "experiments/kinds/calibrate_plucks.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "experiments/kinds/calibrate_study.hpp"
#include "libsim/base/error.hpp"

namespace modcal {

void PluckRecordOptions::visit(OptionVisitor& visitor) {
  visitor.plugin({.key = "initial", .meaning = "how a simulated string is plucked"}, start);
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
  visitor.number({.key = "left_noise",
                  .meaning = "noise standard deviation of the reaction at x = 0",
                  .unit = "N",
                  .range = Range::positive(),
                  .word = "estimated"},
                 left_noise);
  visitor.number({.key = "right_noise",
                  .meaning = "noise standard deviation of the reaction at x = L",
                  .unit = "N",
                  .range = Range::positive(),
                  .word = "estimated"},
                 right_noise);
}

void require_plucks(const std::vector<PluckRecordOptions>& plucks, const ObservationOptions& first,
                    const CalibrationOptions& calibration) {
  MODCAL_REQUIRE(plucks.empty() || calibration.has_continuation,
                 "{} plucks are fitted with the stroke by the joint likelihood alone: state "
                 "calibration.continuation",
                 plucks.size());
  for (const PluckRecordOptions& pluck : plucks) {
    if (!pluck.file.empty()) {
      MODCAL_REQUIRE(
          first.has_record,
          "the recorded pluck {} goes with a recorded stroke: state record, or pluck the "
          "string of the scene",
          pluck.file);
      continue;
    }
    MODCAL_REQUIRE(first.has_scene,
                   "{} plucks, one of them simulated, but there is no scene: name its record",
                   plucks.size());
    MODCAL_REQUIRE(pluck.start.selected() != "rest", "a string at {} has no free decay: pluck it",
                   pluck.start.selected());
    pluck.start.make();
    const ModalBasis basis = make_modal_basis(first.string_model());
    const double top =
        *std::max_element(basis.omega.begin(), basis.omega.end()) / (2.0 * std::numbers::pi);
    MODCAL_REQUIRE(pluck.sample_rate > 2.0 * top,
                   "a pluck sampled at {:g} Hz, but the highest mode is at {:g} Hz: sample at more "
                   "than twice that, or use fewer modes",
                   pluck.sample_rate, top);
  }
}

std::vector<PluckRecord> observe_plucks(const std::vector<PluckRecordOptions>& plucks,
                                        const ObservationOptions& first, const StreamKey& key,
                                        const StudyContext& context) {
  std::vector<PluckRecord> records;
  for (const PluckRecordOptions& pluck : plucks) {
    context.throw_if_interrupted();
    ObservationOptions options = first;
    if (pluck.file.empty()) {
      Scene& scene = options.truth.scene;
      scene.bow.velocity = 0.0;
      scene.bow.normal_force = 0.0;
      scene.start = pluck.start;
      scene.duration = pluck.duration;
      options.measurement.noise_level = pluck.noise_level;
      options.measurement.sample_rate = pluck.sample_rate;
    } else {
      options.record.file = pluck.file;
    }
    const StreamKey own = key.with("pluck").with(static_cast<std::uint64_t>(records.size() + 1));
    const Observation found = observe(options, {.left_reaction = true, .right_reaction = true},
                                      context.work.truths, own, context.folder);
    records.push_back(
        {.data = calibration_data(found), .noise = {pluck.left_noise, pluck.right_noise}});
  }
  return records;
}

}  // namespace modcal
