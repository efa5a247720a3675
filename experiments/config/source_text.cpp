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

std::size_t end_of_quoted(std::string_view text, std::size_t start) {
  const char quote = text[start];
  for (std::size_t i = start + 1; i < text.size(); ++i) {
    if (quote == '"' && text[i] == '\\') {
      ++i;
    } else if (text[i] == quote) {
      if (quote == '"' || i + 1 >= text.size() || text[i + 1] != quote) return i + 1;
      ++i;
    }
  }
  return std::string_view::npos;
}

std::vector<std::size_t> line_starts(std::string_view text) {
  std::vector<std::size_t> starts = {0};
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\n') starts.push_back(i + 1);
  }
  return starts;
}

bool is_closed(std::string_view text, const SourcePosition& place) {
  const std::vector<std::size_t> starts = line_starts(text);
  int depth = 0;
  for (std::size_t i = starts[place.line - 1] + place.column - 1; i < text.size(); ++i) {
    const char c = text[i];
    const bool begins =
        i == 0 || std::string_view(" \n,[{:").find(text[i - 1]) != std::string::npos;
    if (begins && (c == '"' || c == '\'')) {
      i = std::min(end_of_quoted(text, i), text.size()) - 1;
    } else if (begins && c == '#') {
      i = std::min(text.find('\n', i), text.size());
    } else if (c == '[' || c == '{') {
      ++depth;
    } else if ((c == ']' || c == '}') && --depth == 0) {
      return true;
    }
  }
  return false;
}

std::optional<Mistake> mistake_above(const std::string& text, std::size_t line) {
  const std::vector<std::size_t> starts = line_starts(text);
  while (--line >= 1) {
    const std::string_view above(text.data() + starts[line - 1],
                                 starts[line] - 1 - starts[line - 1]);
    const std::size_t first = above.find_first_not_of(" \r");
    if (first == std::string_view::npos || above[first] == '#') continue;
    const std::size_t last = above.find_last_not_of(" \r");
    if (above.find(": ") != std::string_view::npos || above[last] == ':') return std::nullopt;
    if (const std::size_t colon = above.find(':'); colon != std::string_view::npos) {
      return Mistake{{line, colon + 1, {}}, "no blank behind the colon: write \"key: value\""};
    }
    if (const std::size_t equals = above.find('='); equals != std::string_view::npos) {
      return Mistake{{line, equals + 1, {}},
                     "a \"=\" in the place of the colon: write \"key: value\""};
    }
    return Mistake{{line, first + 1, {}},
                   "neither a \"key: value\" nor an item of a list: a colon is missing"};
  }
  return std::nullopt;
}

}  // namespace modcal
