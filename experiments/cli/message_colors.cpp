#include "experiments/cli/message_colors.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace modcal {
namespace {

constexpr std::string_view kRed = "\033[1;31m", kYellow = "\033[1;33m", kEnd = "\033[0m";

// Marks a word that begins the line or follows the place of a mistake, "a.yaml:3:7: error: …".
bool mark(std::string& line, std::string_view word, std::string_view color) {
  const std::size_t found = line.find(word);
  if (found == std::string::npos) return false;
  const bool after_place = found >= 2 && line.compare(found - 2, 2, ": ") == 0;
  if (found != 0 && !after_place) return false;
  line.insert(found + word.size(), kEnd);
  line.insert(found, color);
  return true;
}

bool is_caret(std::string_view line) {
  const std::size_t first = line.find_first_not_of(' ');
  return first != std::string_view::npos && line.substr(first) == "^";
}

}  // namespace

bool messages_have_colors() {
  const char* refused = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  return isatty(STDERR_FILENO) != 0 && (refused == nullptr || *refused == '\0') &&
         terminal != nullptr && std::string_view(terminal) != "dumb";
}

std::string with_color_codes(const std::string& text) {
  std::string result;
  std::string_view color = kRed;  // of the caret below the last message
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    std::string line = text.substr(start, end - start);
    if (mark(line, "error:", kRed)) {
      color = kRed;
    } else if (mark(line, "warning:", kYellow)) {
      color = kYellow;
    } else if (is_caret(line)) {
      line.insert(0, color);
      line += kEnd;
    }
    result += line;
    if (end < text.size()) result += '\n';
    start = end + 1;
  }
  return result;
}

std::string colored(const std::string& text) {
  return messages_have_colors() ? with_color_codes(text) : text;
}

}  // namespace modcal
