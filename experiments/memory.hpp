// Memory that a run needs, and that there is.
#pragma once

#include <string>

#include "experiments/experiment.hpp"

namespace modcal {

/// Memory that a run on this many threads needs, about, from the sizes of its simulations alone
/// [B].
double memory_needed(const Experiment& experiment, std::size_t threads);

/// Memory that reading records and the work on them needs, about, from the sizes of the files and
/// their headers alone [B]; 0: of no file it is known. threads: as above.
double memory_of_files(const Experiment& experiment, const std::filesystem::path& folder,
                       std::size_t threads);

/// Memory of the machine, or what of it this process may have [B].
double machine_memory();

/// "27.3 GB".
std::string bytes_text(double bytes);

}  // namespace modcal
