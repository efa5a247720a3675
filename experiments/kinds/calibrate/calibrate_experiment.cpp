// What a calibration would do.
#include "experiments/kinds/calibrate/calibrate.hpp"
#include "experiments/kinds/lint.hpp"

namespace modcal {

// Of each stroke and pluck, about: its spectra, their models and the derivatives of these, which
// are as many as modes in every bin of the band. Violin D, 52 modes up to 0.35 sampling rates, 1 to
// 6 s: 710 to 740; cello C, whose band ends at 0.1: 290. A file's size tells no band: a wide one.
constexpr double kNumbersPerSample = 750.0;

std::vector<PlanLine> CalibrateOptions::plan() const {
  if (has_structure) return structure.plan();
  const ObservationOptions& observation = inversion.observation;
  std::vector<PlanLine> lines = {source_line(planned_simulations(), observation)};
  const StringModel string = observation.string_model().before_reading();
  const auto modes = static_cast<std::size_t>(string.modes);
  const bool of_record = observation.string_model().modes_of_record();
  const std::size_t free = calibration.parameters.names(modes).size();
  lines.push_back(
      {fmt::format("calibration: {} parameters asked for{}, objective {}, optimizer {}, at "
                   "most {} evaluations",
                   free,
                   of_record
                       ? fmt::format(" (of {} modes; the record tells how many there are)", modes)
                       : "",
                   calibration.objective.selected(), calibration.optimizer.selected(),
                   calibration.budget.evaluations),
       {{"calibration",
         {{"parameters", free},
          {"modes", modes},
          {"modes_of_record", of_record},
          {"objective", calibration.objective.selected()},
          {"optimizer", calibration.optimizer.selected()},
          {"evaluations", calibration.budget.evaluations}}}}});
  const std::size_t strokes = 1 + further.contacts.size() + further.files.size();
  if (strokes > 1) {
    lines.push_back({fmt::format("strokes fitted together: {}", strokes), {{"strokes", strokes}}});
  }
  if (!plucks.empty()) {
    lines.push_back(
        {fmt::format("plucks fitted with them: {}", plucks.size()), {{"plucks", plucks.size()}}});
  }
  return lines;
}

std::optional<PlannedSimulations> CalibrateOptions::planned_simulations() const {
  if (has_structure) return std::nullopt;
  const ObservationOptions& first = inversion.observation;
  auto planned = planned_truths(first, truth_outputs(inversion.figures, inversion.overview),
                                1 + further.contacts.size());
  for (const PluckRecordOptions& pluck : plucks) {
    if (planned && pluck.file.empty()) add_planned(pluck.observation(first), *planned);
  }
  return planned;
}

std::vector<FileRead> CalibrateOptions::files_read() const {
  if (has_structure) return structure.files_read();
  std::vector<FileRead> files = inversion.files_read();
  const auto add = [&](const std::string& file, std::string key) {
    RecordOptions record = inversion.observation.record;  // laid out as the first one
    record.file = file;
    files.push_back(file_read(record, std::move(key), kNumbersPerSample));
  };
  if (!files.empty()) files.front().numbers_per_sample = kNumbersPerSample;
  for (std::size_t i = 0; i < further.files.size(); ++i) {
    add(further.files[i], fmt::format("further_strokes.records.{}", i));
  }
  for (std::size_t i = 0; i < plucks.size(); ++i) {
    if (!plucks[i].file.empty()) add(plucks[i].file, fmt::format("plucks.{}.record", i));
  }
  return files;
}

LimitQuestion CalibrateOptions::limit_question() const {
  MODCAL_REQUIRE(!has_structure,
                 "the limit of a structure depends on the force that acts: kind: calibration_limit "
                 "with structure: simulates one");
  const ObservationOptions& first = inversion.observation;
  LimitQuestion question{.observation = first,
                         .noise_level = first.measurement.noise_level,
                         .further_contacts = further.contacts};
  question.calibrate_by(calibration);
  for (const PluckRecordOptions& pluck : plucks) {
    question.plucks.push_back(pluck.observation(first));
  }
  return question;
}

}  // namespace modcal
