#pragma once

#include <string>
#include <string_view>

namespace modcal::report {

/// Text for HTML content and quoted attributes: & < > " ' are escaped.
std::string html_escaped(std::string_view text);

/// The escaped text as <p> elements; an empty line starts a new one.
std::string html_paragraphs(std::string_view text);

}  // namespace modcal::report
