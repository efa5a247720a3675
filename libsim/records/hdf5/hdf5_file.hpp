// HDF5 files (version 7.3 of MAT files has a reader of its own).
#pragma once

#include <mutex>
#include <string>

#include "libsim/records/arrays/written_arrays.hpp"
#include "libsim/records/stored_channels.hpp"

namespace modcal {

/// Debian's HDF5 is not made for threads: held over every call of it.
std::mutex& hdf5_lock();

/// Reads datasets of numbers as recording_of() says; attributes are names below their dataset or
/// group: `unit`, `sample_rate`, `dt` and the like; `name` is the channel's. Data that stand in
/// other files are not read. Throws InvalidInput for what is no whole HDF5 file.
Recording read_hdf5(const std::filesystem::path& path, const ReadOptions& options = {});

/// Response functions and coherences as functions_of() lists them.
std::vector<StoredChannel> hdf5_functions(const std::filesystem::path& path);

/// Writes a dataset an array with the attributes `unit` and `name`, the axis as an attribute of the
/// file or a dataset, and `provenance`. Throws InvalidInput where it cannot be written.
void write_hdf5(const std::filesystem::path& path, const WrittenArrays& arrays);

}  // namespace modcal
