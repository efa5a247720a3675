// HDF5 files (version 7.3 of MAT files has a reader of its own).
#pragma once

#include <mutex>
#include <span>
#include <string>

#include "libsim/records/record_file.hpp"
#include "libsim/records/response_functions.hpp"

namespace modcal {

/// Debian's HDF5 is not made for threads: held over every call of it.
std::mutex& hdf5_lock();

/// Reads datasets of numbers as recording_of() says; attributes are names below their dataset or
/// group: `unit`, `sample_rate`, `dt` and the like; `name` is the channel's. Data that stand in
/// other files are not read. Throws InvalidInput for what is no whole HDF5 file.
Recording read_hdf5(const std::filesystem::path& path, const ReadOptions& options = {});

/// Response functions and coherences as responses_of() reads them.
ResponseFunctions read_hdf5_responses(const std::filesystem::path& path,
                                      const std::vector<std::string>& channels,
                                      FrequencyFunction wanted);

/// Writes a dataset of doubles a signal with the attributes `unit` and `name`, and `sample_rate`
/// [Hz] and `provenance` of the file.
void write_hdf5(const std::filesystem::path& path, std::span<const Signal> signals,
                const std::string& provenance);

}  // namespace modcal
