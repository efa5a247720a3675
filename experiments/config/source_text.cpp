#include "experiments/config/source_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "libsim/base/utf8.hpp"

namespace modcal {
bool is_utf8(YamlDocument& document, std::string_view text) {
  const std::size_t bad = first_not_utf8(text);
  if (bad == std::string_view::npos) return true;
  const auto line = static_cast<std::size_t>(std::count(text.begin(), text.begin() + bad, '\n'));
  const std::size_t start = text.substr(0, bad).rfind('\n') + 1;  // npos + 1 is 0
  document.mistakes.push_back(
      {{line + 1, bad - start + 1, {}},
       fmt::format("byte 0x{:02x} is not UTF-8 text: save the file as UTF-8",
                   static_cast<unsigned char>(text[bad]))});
  return false;
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

}  // namespace modcal
