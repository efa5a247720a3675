#include "libsim/records/universal/universal_types.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "libsim/records/csv_grammar.hpp"

namespace modcal {
namespace {

// In the order of FrequencyFunction.
constexpr std::array kTypes = {4, 6, 2, 9};

// What stands before the mark, taken off the text; NaN: no number, or no mark.
double number_before(std::string_view mark, std::string_view& text) {
  const std::size_t at = text.find(mark);
  if (at == std::string_view::npos) return std::numeric_limits<double>::quiet_NaN();
  const ParsedNumber number = parse_number(text.substr(0, at));
  text.remove_prefix(at + mark.size());
  return number.value;
}

}  // namespace

std::optional<FrequencyFunction> what_of_type(int type) {
  const auto found = std::ranges::find(kTypes, type);
  if (found == kTypes.end()) return std::nullopt;
  return static_cast<FrequencyFunction>(found - kTypes.begin());
}

int type_of(FrequencyFunction what) { return kTypes[static_cast<std::size_t>(what)]; }

std::string lines_text(const EvenLines& lines) {
  return fmt::format("lines: ({} + {} m) {}/{} Hz", lines.first, lines.step, lines.times,
                     lines.per);
}

bool read_lines_text(std::string_view text, EvenLines& lines) {
  constexpr std::string_view kBegin = "lines: (";
  if (!text.starts_with(kBegin)) return false;
  text.remove_prefix(kBegin.size());
  const EvenLines read{.first = number_before(" + ", text),
                       .step = number_before(" m) ", text),
                       .times = number_before("/", text),
                       .per = number_before(" Hz", text)};
  const bool is_good =
      read.per > 0.0 && read.times > 0.0 && read.step > 0.0 && std::isfinite(read.first);
  if (!is_good || !text.empty()) return false;
  lines = read;
  return true;
}

}  // namespace modcal
