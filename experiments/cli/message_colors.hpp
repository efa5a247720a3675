// Colours of messages on a terminal.
#pragma once

#include <string>

namespace modcal {

/// Messages on standard error may be coloured: it is a terminal that is not "dumb", and NO_COLOR is
/// not set (no-color.org: set to anything but the empty text).
bool messages_have_colors();

/// The text with "error:", "warning:" and carets marked, where messages may be coloured.
std::string colored(const std::string& text);
/// The same whatever the terminal.
std::string with_color_codes(const std::string& text);

}  // namespace modcal
