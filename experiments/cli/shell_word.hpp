#pragma once

#include <string>

namespace modcal {

/// One word of a POSIX shell; single-quoted where anything in it could be special.
std::string shell_word(const std::string& text);

}  // namespace modcal
