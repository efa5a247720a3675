// Names of tasks and digests of results.
#pragma once

#include <string>
#include <string_view>

namespace modcal {

/// 32 hexadecimal digits (XXH3, 128 bits) that are equal for equal texts.
std::string digest_of(std::string_view text);

/// 16 hexadecimal digits (XXH3, 64 bits) that tell a damaged line.
std::string checksum_of(std::string_view text);

}  // namespace modcal
