#include "libsim/records/universal/columns.hpp"

#include <algorithm>
#include <charconv>

#include "libsim/base/error.hpp"
#include "libsim/base/utf8.hpp"
#include "libsim/base/words.hpp"
#include "libsim/records/csv_grammar.hpp"

namespace modcal {

bool is_delimiter(std::string_view line) { return trimmed(line) == "-1"; }

std::string known_field(std::string_view text) {
  const std::string_view word = trimmed(text);
  return word == "NONE" ? std::string() : std::string(word);
}

Columns::Columns(std::string_view line, std::string where)
    : text_(utf8_or_latin1(line)), where_(std::move(where)) {}

std::string_view Columns::text(std::size_t first, std::size_t count) const {
  return std::string_view(text_).substr(byte(first), byte(first + count) - byte(first));
}

long long Columns::whole(std::size_t first, std::size_t count) const {
  const std::string_view field = trimmed(text(first, count));
  long long value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  const bool good = error == std::errc() && end == field.data() + field.size();
  MODCAL_REQUIRE(good || field.empty(), "{}: \"{}\" in column {} is no whole number", where_, field,
                 first + 1);
  return value;
}

int Columns::small(std::size_t first, std::size_t count) const {
  return static_cast<int>(std::clamp<long long>(whole(first, count), -9999999, 9999999));
}

double Columns::number(std::size_t first, std::size_t count) const {
  std::string field(trimmed(text(first, count)));
  std::replace(field.begin(), field.end(), 'D', 'E');
  if (field.empty()) return 0.0;
  const ParsedNumber parsed = parse_number(field);
  MODCAL_REQUIRE(parsed.kind == NumberKind::kNumber, "{}: \"{}\" in column {} is no number", where_,
                 field, first + 1);
  return parsed.value;
}

double Columns::stated_number(std::size_t first, std::size_t count) const {
  MODCAL_REQUIRE(!trimmed(text(first, count)).empty(), "{}: a number is expected in column {}",
                 where_, first + 1);
  return number(first, count);
}

std::size_t Columns::byte(std::size_t column) const {
  std::size_t at = 0;
  for (; column > 0 && at < text_.size(); --column) {
    at += std::max<std::size_t>(1, utf8_size(std::string_view(text_).substr(at)));
  }
  return std::min(at, text_.size());
}

}  // namespace modcal
