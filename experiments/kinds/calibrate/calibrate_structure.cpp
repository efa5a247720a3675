// Kind "calibrate" where a table of modes stands in the place of the string.
#include "experiments/kinds/calibrate/calibrate.hpp"
#include "experiments/kinds/lint.hpp"

namespace modcal {
namespace {

template <typename Item>
std::vector<Item> below_structure(std::vector<Item> items, std::string Item::*path) {
  for (Item& item : items) item.*path = "structure." + item.*path;
  return items;
}

}  // namespace

std::vector<Finding> StructureCalibrationOptions::lint() const {
  return below_structure(IdentifyForceOptions::lint(), &Finding::path);
}

std::vector<Finding> StructureCalibrationOptions::lint_records(
    const std::filesystem::path& folder) const {
  return below_structure(IdentifyForceOptions::lint_records(folder), &Finding::path);
}

std::vector<FileRead> StructureCalibrationOptions::files_read() const {
  return below_structure(IdentifyForceOptions::files_read(), &FileRead::key);
}

std::vector<PlanLine> StructureCalibrationOptions::plan() const {
  return {{fmt::format("refine the modes of {} by {} responses of {}, without their force", table,
                       record.responses.size(), record.file),
           {{"responses", record.responses.size()}, {"record", record.file}, {"table", table}}}};
}

StudyResult StructureCalibrationOptions::run(const StudyContext& context, std::int64_t key) const {
  StructureCalibrationOptions keyed = *this;
  keyed.seed = key;
  return keyed.found(context, true);
}

// Keys of a string are refused: they would do nothing.
std::vector<Finding> CalibrateOptions::lint_structure() const {
  std::vector<Finding> findings = structure.lint();
  const CalibrateOptions plain;
  const InvertOptions &mine = inversion, &usual = plain.inversion;
  refuse_beside_structure(
      {{"scene", mine.observation.has_scene},
       {"record", mine.observation.has_record},
       {"string", mine.observation.has_string},
       {"bow", mine.observation.has_bow},
       {"measurement", !same_options(mine.observation.measurement, usual.observation.measurement)},
       {"model_error", !same_options(mine.model_error, usual.model_error)},
       {"inversion", !same_options(mine.inversion, usual.inversion)},
       {"model_based", mine.has_model_based},
       {"calibration", !same_options(calibration, plain.calibration)},
       {"further_strokes", !same_options(further, plain.further)},
       {"plucks", !plucks.empty()},
       {"figures", !mine.figures.empty()}},
      findings);
  return findings;
}

}  // namespace modcal
