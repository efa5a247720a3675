// Formulas within texts as a reader of a journal knows them.
#pragma once

#include <string>
#include <string_view>

namespace modcal::report {

/// Text for HTML content, escaped: f_n, f0, R1 with their subscripts, χ² and ±, 2.99e-09
/// as 2.99×10⁻⁹.
std::string typeset_html(std::string_view text);

/// 2.99e-09 as 2.99×10⁻⁹, all else as it is.
std::string typeset_powers(std::string_view text);

}  // namespace modcal::report
