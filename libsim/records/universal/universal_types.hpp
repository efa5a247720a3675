// What datasets 58 of functions of frequency have in common where they are read and written.
#pragma once

#include <optional>
#include <string>

#include "libsim/records/frequency_lines.hpp"
#include "libsim/records/response_functions.hpp"

namespace modcal {

/// What a function of a type is; nothing for types that are no function of frequency that is read.
std::optional<FrequencyFunction> what_of_type(int type);
/// The type that what_of_type() tells.
int type_of(FrequencyFunction what);

/// Even lines to their last digit, in an ID line: "lines: (0 + 1 m) 1/10 Hz".
std::string lines_text(const EvenLines& lines);
/// False for any other text; `lines` stays then.
bool read_lines_text(std::string_view text, EvenLines& lines);

}  // namespace modcal
