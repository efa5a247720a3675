// Measured response functions in the place of a table's modes.
#pragma once

#include "experiments/kinds/structure/structure_files.hpp"

namespace modcal {

/// Share by which a sensor's model may be off where its table does not state it: sessions tell it
/// by themselves.
double scatter_untold(const std::vector<std::string>& sessions);

/// The functions that a table names; file: of the table, for messages and folder. Sensors that the
/// table states are those of the functions. Throws InvalidInput for functions that do not cover the
/// table's band, other sensors, and as load_response_functions() does.
void take_functions(const ResponseFunctionOptions& options, const std::filesystem::path& file,
                    StructureTable& table);

}  // namespace modcal
