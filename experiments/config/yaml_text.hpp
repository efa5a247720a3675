// YAML text to a document's tree.
#pragma once

#include <string>

#include "experiments/config/document.hpp"

namespace modcal {

/// Fills root and mistakes of `document`. The first `skip` bytes of the text are no part of the
/// YAML: places count them.
void parse_yaml_text(YamlDocument& document, const std::string& text, std::size_t skip);

/// Number of characters of UTF-8 text.
std::size_t count_characters(std::string_view text);

}  // namespace modcal
