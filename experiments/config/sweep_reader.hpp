// The section "sweep" of an experiment: from axes to cells.
#pragma once

#include <string>
#include <vector>

#include "experiments/config/document.hpp"
#include "libsim/base/sweep.hpp"

namespace modcal {

/// A sweep as written, with the places of its values.
struct SweepTable {
  SweepPlan plan;
  std::vector<std::string> paths;
  std::vector<SourcePosition> places;                ///< of the paths
  std::vector<std::vector<const YamlNode*>> values;  ///< of every cell; null: its own
  SweepCells cells() const;
};

/// Reads {product, zip, exclude, include}; mistakes are appended, and with one of them the table is
/// empty. The nodes must outlive the table.
SweepTable read_sweep(const YamlNode& node, std::string_view key, std::vector<Mistake>& mistakes);

}  // namespace modcal
