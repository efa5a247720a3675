// Whether a file is text that YAML can be read from.
#pragma once

#include <string>
#include <string_view>

#include "experiments/config/document.hpp"

namespace modcal {

/// Else a mistake of the document says which byte is not.
bool is_utf8(YamlDocument& document, std::string_view text);
/// In the indentation of a line; a mistake of the document says where.
bool has_tabs(YamlDocument& document, const std::string& text);

}  // namespace modcal
