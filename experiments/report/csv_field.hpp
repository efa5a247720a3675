#pragma once

#include <string>
#include <string_view>

namespace modcal::report {

/// A CSV field of text, quoted where RFC 4180 asks for it.
std::string csv_field(std::string_view text);

/// A CSV field of a number with all its digits; "nan", "inf", "-inf".
std::string csv_field(double value);

}  // namespace modcal::report
