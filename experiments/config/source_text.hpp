// Whether a file is text that YAML can be read from.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "experiments/config/document.hpp"

namespace modcal {

/// Else a mistake of the document says which byte is not.
bool is_utf8(YamlDocument& document, std::string_view text);
/// In the indentation of a line; a mistake of the document says where.
bool has_tabs(YamlDocument& document, const std::string& text);

/// Byte behind the closing quote of the text that begins at `start`; npos where it is not closed.
std::size_t end_of_quoted(std::string_view text, std::size_t start);
/// Where every line begins.
std::vector<std::size_t> line_starts(std::string_view text);
/// Whether the bracket at `place` has its other one. Quotes are closed, else that is the mistake.
bool is_closed(std::string_view text, const SourcePosition& place);
/// What is wrong with the last line above `line` that is neither blank nor a comment, where it is
/// no "key: value": yaml-cpp joins it with the next one and stumbles over the colon there.
std::optional<Mistake> mistake_above(const std::string& text, std::size_t line);

}  // namespace modcal
