// Section `structure` of kind "calibrate": a table of modes in the place of a string.
#pragma once

#include "experiments/kinds/structure/structure_kinds.hpp"

namespace modcal {

/// A table's modes refined by K responses, and the force that these tell by the refined modes.
struct StructureCalibrationOptions : IdentifyForceOptions {
  void visit(OptionVisitor& visitor) {
    visit_keys(visitor);
    refines = true;
  }
  /// Paths begin with "structure.".
  std::vector<Finding> lint() const;
  std::vector<Finding> lint_records(const std::filesystem::path& folder) const;
  std::vector<FileRead> files_read() const;
  std::vector<PlanLine> plan() const;
  /// key: of the draws.
  StudyResult run(const StudyContext& context, std::int64_t key) const;
};

}  // namespace modcal
