// Kind "calibrate" where a table of modes stands in the place of the string.
#include "experiments/kinds/calibrate/calibrate.hpp"
#include "experiments/kinds/lint.hpp"

namespace modcal {
namespace {

struct SimulatorAlone {
  Choice<Simulator> simulator;
  void visit(OptionVisitor& visitor) { visitor("simulator", "", simulator); }
};

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
       {"simulator", !same_options(SimulatorAlone{mine.observation.truth.simulator},
                                   SimulatorAlone{usual.observation.truth.simulator})},
       {"wave_based", mine.wave_based},
       {"score", !same_options(mine.score, usual.score)},
       {"write_sound", mine.write_sound},
       {"write_signals", mine.write_signals != usual.write_signals},
       {"overview", mine.overview != usual.overview},
       {"audio", audio},
       {"fill_blind_modes", fill_blind_modes},
       {"calibration", !same_options(calibration, plain.calibration)},
       {"further_strokes", !same_options(further, plain.further)},
       {"plucks", !plucks.empty()},
       {"figures", !mine.figures.empty()}},
      findings);
  return findings;
}

}  // namespace modcal
