// NumPy's files: an array (NPY), or several in a ZIP archive (NPZ).
#pragma once

#include <span>
#include <string>

#include "libsim/records/record_file.hpp"
#include "libsim/records/response_functions.hpp"

namespace modcal {

/// Reads an array of numbers of any kind and order of bytes, in the order of C or Fortran; fields
/// of a structured one are channels, their names as headings ("R1 [N]"), a field t or time [s]
/// tells the sample rate. Throws InvalidInput with the byte for what is no whole NPY file; objects
/// of Python are never unpickled.
Recording read_npy(const std::filesystem::path& path, const ReadOptions& options = {});

/// Response functions and coherences as responses_of() reads them.
ResponseFunctions read_npy_responses(const std::filesystem::path& path,
                                     const std::vector<std::string>& channels,
                                     FrequencyFunction wanted);

/// Reads the arrays of an archive as recording_of() says; checksums are compared.
Recording read_npz(const std::filesystem::path& path, const ReadOptions& options = {});

/// Response functions and coherences as responses_of() reads them.
ResponseFunctions read_npz_responses(const std::filesystem::path& path,
                                     const std::vector<std::string>& channels,
                                     FrequencyFunction wanted);

/// Writes a structured array of doubles: t [s] and a field a signal, "R1 [N]". Every bit of the
/// samples is kept.
void write_npy(const std::filesystem::path& path, std::span<const Signal> signals,
               const std::string& provenance);

/// Writes an array of doubles a signal by its name, its unit as "NAME.unit", and sample_rate [Hz].
void write_npz(const std::filesystem::path& path, std::span<const Signal> signals,
               const std::string& provenance);

}  // namespace modcal
