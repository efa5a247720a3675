// NumPy's files: an array (NPY), or several in a ZIP archive (NPZ).
#pragma once

#include <span>
#include <string>

#include "libsim/records/arrays/written_arrays.hpp"
#include "libsim/records/stored_channels.hpp"

namespace modcal {

/// Reads an array of numbers of any kind and order of bytes, in the order of C or Fortran; fields
/// of a structured one are channels, their names as headings ("R1 [N]"), a field t or time [s]
/// tells the sample rate. Throws InvalidInput with the byte for what is no whole NPY file; objects
/// of Python are never unpickled.
Recording read_npy(const std::filesystem::path& path, const ReadOptions& options = {});

/// Response functions and coherences as functions_of() lists them.
std::vector<StoredChannel> npy_functions(const std::filesystem::path& path);

/// Reads the arrays of an archive as recording_of() says; checksums are compared.
Recording read_npz(const std::filesystem::path& path, const ReadOptions& options = {});

/// Response functions and coherences as functions_of() lists them.
std::vector<StoredChannel> npz_functions(const std::filesystem::path& path);

/// Writes a structured array of doubles: t [s] and a field a signal, "R1 [N]". Every bit of the
/// samples is kept.
void write_npy(const std::filesystem::path& path, std::span<const Signal> signals,
               const RecordNotes& notes);

/// Writes an array by its name, its unit as "NAME.unit", and the axis. Throws InvalidInput for a
/// name that the axis has, and where the file cannot be written.
void write_npz(const std::filesystem::path& path, const WrittenArrays& arrays);

}  // namespace modcal
