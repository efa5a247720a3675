// LabVIEW's measurement files (LVM): text with a header, and one more a segment.
#pragma once

#include <span>
#include <string>

#include "libsim/records/record_file.hpp"

namespace modcal {

/// Reads versions 0.92 to 2 with no, one or several columns X, a point or a comma in the numbers,
/// special headers passed over. Segments of equal channels that follow each other in time without a
/// gap are one record; others are channels "NAME (2)". The sample rate is 1/Delta_X, checked
/// against the columns X. Throws InvalidInput with line and column for what is no whole LVM file.
Recording read_lvm(const std::filesystem::path& path, const ReadOptions& options = {});

/// Writes one segment without columns X; every bit of the samples is kept.
void write_lvm(const std::filesystem::path& path, std::span<const Signal> signals,
               const RecordNotes& notes);

}  // namespace modcal
