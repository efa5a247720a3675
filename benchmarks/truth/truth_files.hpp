// Records and their truth as files.
#pragma once

#include <filesystem>

#include "benchmarks/truth/truth.hpp"

namespace modcal::truth {

/// Columns t [s], R1 [N], R2 [N], f_c [N], y [m], v [m/s], twelve digits. Throws std::runtime_error
/// where the file cannot be written.
void write_record(const std::filesystem::path& path, const TruthRecord& record);

/// What is true of it, in JSON and SI units: f0, B, x_c, L, T, linear density, law of the damping;
/// f and zeta of all modes of the scheme; what the reactions hold; noise, rates, filter, audit.
void write_truth(const std::filesystem::path& path, const TruthString& string,
                 const TruthGesture& gesture, const TruthOptions& options,
                 const TruthRecord& record);

}  // namespace modcal::truth
