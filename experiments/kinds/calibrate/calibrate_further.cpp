// Further strokes and plucks that a calibration fits together with the first stroke.
#include "experiments/kinds/calibrate/calibrate.hpp"
#include "libcalib/likelihood/records/record_options.hpp"

namespace modcal {

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

void visit_pluck(OptionVisitor& visitor, Choice<InitialMotion>& start, double& duration,
                 double& noise_level) {
  visitor("initial", "how a simulated string is plucked; a recorded one needs none", start);
  visitor("duration", "length of the simulated free decay",
          {.unit = "s", .range = Range::positive()}, duration);
  visitor("noise_level",
          "standard deviation of the simulated noise, relative to that of each "
          "reaction",
          {.range = Range::non_negative()}, noise_level);
}

void PluckRecordOptions::visit(OptionVisitor& visitor) {
  visit_pluck(visitor, start, duration, noise_level);
  visitor("sample_rate", "sample rate of the simulated reactions",
          {.unit = "Hz", .range = Range::positive()}, sample_rate);
  visitor("record",
          "a recorded file in the place of a simulated pluck, with the channels of "
          "the stroke's; it begins when the string has been let go",
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

void require_different_strokes(const std::vector<Observation>& strokes) {
  for (std::size_t r = 1; r < strokes.size(); ++r) {
    for (std::size_t s = 0; s < r; ++s) {
      const auto &one = strokes[s].reactions[0], &other = strokes[r].reactions[0];
      MODCAL_REQUIRE(!one || !other || one->samples != other->samples,
                     "strokes {} and {} have the same samples at x = 0: one is a copy, which tells "
                     "nothing more; leave it out",
                     s + 1, r + 1);
    }
  }
}

}  // namespace modcal
