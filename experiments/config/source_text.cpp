#include "experiments/config/source_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

namespace modcal {
namespace {

bool is_continuation(char byte) { return (static_cast<unsigned char>(byte) & 0xC0) == 0x80; }

// Bytes of the UTF-8 character that begins the text; 0 where none does.
std::size_t character_size(std::string_view text) {
  const auto first = static_cast<unsigned char>(text[0]);
  std::size_t size = 0;
  if (first > 0 && first < 0x80) size = 1;
  if (first >= 0xC2 && first <= 0xDF) size = 2;
  if (first >= 0xE0 && first <= 0xEF) size = 3;
  if (first >= 0xF0 && first <= 0xF4) size = 4;
  if (size == 0 || size > text.size()) return 0;
  // Longer than need be, a half of a UTF-16 pair, beyond the last character (RFC 3629).
  const auto second = static_cast<unsigned char>(size > 1 ? text[1] : '\0');
  if ((first == 0xE0 && second < 0xA0) || (first == 0xED && second >= 0xA0) ||
      (first == 0xF0 && second < 0x90) || (first == 0xF4 && second >= 0x90)) {
    return 0;
  }
  const std::string_view rest = text.substr(1, size - 1);
  return std::all_of(rest.begin(), rest.end(), is_continuation) ? size : 0;
}

}  // namespace

bool is_utf8(YamlDocument& document, std::string_view text) {
  SourcePosition position{1, 1, {}};
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t size = character_size(text.substr(i));
    if (size == 0) {
      document.mistakes.push_back(
          {position, fmt::format("byte 0x{:02x} is not UTF-8 text: save the file as UTF-8",
                                 static_cast<unsigned char>(text[i]))});
      return false;
    }
    position.column += size;
    if (text[i] == '\n') position = {position.line + 1, 1, {}};
    i += size;
  }
  return true;
}

bool has_tabs(YamlDocument& document, const std::string& text) {
  std::istringstream stream(text);
  std::size_t number = 0;
  bool found = false;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    const std::size_t first = line.find_first_not_of(" \t\r");
    const std::size_t tab = line.find('\t');
    if (first == std::string::npos || line[first] == '#' || tab > first) continue;
    document.mistakes.push_back({{number, tab + 1, {}}, "a tab in the indentation: use blanks"});
    found = true;
  }
  return found;
}

std::size_t count_characters(std::string_view text) {
  return text.size() -
         static_cast<std::size_t>(std::count_if(text.begin(), text.end(), is_continuation));
}

}  // namespace modcal
