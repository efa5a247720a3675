// MATLAB's MAT files, versions 4, 5 and 7.3, by libmatio.
#pragma once

#include <string>

#include "libsim/records/arrays/written_arrays.hpp"
#include "libsim/records/stored_channels.hpp"

namespace modcal {

/// The structure in which write_matlab() keeps names and units.
inline constexpr const char* kMatlabHeads = "modcal";

/// Reads vectors and the columns of matrices as channels, fields of structures with dots in their
/// names, as recording_of() says. Names and units are those of a structure `modcal` where
/// write_matlab() left it. A file of version 7.3 in which libmatio passes over numbers is read as
/// HDF5. Throws InvalidInput for what is no whole MAT file.
Recording read_matlab(const std::filesystem::path& path, const ReadOptions& options = {});

/// Response functions and coherences as functions_of() lists them.
std::vector<StoredChannel> matlab_functions(const std::filesystem::path& path);

/// Writes version 5: a column an array, the axis, and a structure `modcal` with names and units.
/// An existing file is replaced only when the new one is complete. Throws InvalidInput where it
/// cannot be written.
void write_matlab(const std::filesystem::path& path, const WrittenArrays& arrays);

}  // namespace modcal
