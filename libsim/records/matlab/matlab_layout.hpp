// What a MAT file states of its own size, before libmatio believes it.
#pragma once

#include <filesystem>

namespace modcal {

/// Throws InvalidInput where a variable is not whole: the file is cut off, what is compressed
/// cannot be unpacked or has another checksum, or a variable states more numbers than it holds.
/// libmatio takes the end of a file for the end of its variables, compares no checksum, takes
/// memory for as much as a header states and leaves in it what it happened to hold.
/// Version 5: a header of 128 bytes, then elements, each with its type and size before it
/// (MathWorks, MAT-File Format, 2019, "Level 5"); version 4: a header of 20 bytes a variable.
/// Version 7.3 is HDF5, which checks itself.
void require_whole_matlab_file(const std::filesystem::path& path);

}  // namespace modcal
