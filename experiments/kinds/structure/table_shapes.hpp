// Modes of a table from the shapes of a universal file.
#pragma once

#include <filesystem>

#include "libinverse/structure/structure_table.hpp"
#include "libsim/base/options.hpp"

namespace modcal {

/// The `shapes:` section of a table, in the place of its modes.
struct ShapesOptions {
  std::string file, contact;
  std::vector<std::string> sensors;
  double damping_ratio = std::numeric_limits<double>::quiet_NaN();
  void visit(OptionVisitor& visitor);
};

/// Poles and constants of the table's sensors; file: of the table, for messages and folder. Throws
/// InvalidInput for what the shapes do not tell.
void take_shapes(const ShapesOptions& options, const std::filesystem::path& file,
                 StructureTable& table);

}  // namespace modcal
