// Numbers of text files.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "libsim/base/error.hpp"
#include "libsim/records/csv_grammar.hpp"

namespace modcal {

ParsedNumber parse_number(std::string_view text) {
  // from_chars takes no plus sign.
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  double value = std::numeric_limits<double>::quiet_NaN();
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error == std::errc::invalid_argument || stop != end) {
    return {NumberKind::kText, std::numeric_limits<double>::quiet_NaN()};
  }
  if (error == std::errc::result_out_of_range) {
    return {NumberKind::kOutOfRange, std::numeric_limits<double>::quiet_NaN()};
  }
  return {std::isfinite(value) ? NumberKind::kNumber : NumberKind::kNotFinite, value};
}

ParsedNumber DecimalMark::parse(std::string_view text, char separator) {
  has_points_ |= text.find('.') != std::string_view::npos;
  const ParsedNumber number = parse_number(text);
  const std::size_t comma = text.find(',');
  if (number.kind != NumberKind::kText || separator == ',' || comma == std::string_view::npos) {
    return number;
  }
  std::string with_point(text);
  with_point[comma] = '.';
  const ParsedNumber found = parse_number(with_point);
  if (found.kind != NumberKind::kNumber) return number;
  if (comma_.empty()) comma_ = text;
  // 1,234 may be a number of four digits; 0,123, 1,23, 1234,567 and 1,234e-3 are not.
  const std::size_t end = std::min(text.find_first_of("eE", comma), text.size());
  const std::size_t first = text.find_first_not_of("+-");
  is_told_ |= end != text.size() || end - comma != 4 || comma - first > 3 || first == comma ||
              text[first] == '0';
  return found;
}

std::string DecimalMark::doubt() const {
  if (comma_.empty() || (is_told_ && !has_points_)) return {};
  return fmt::format("the comma of {} {}; write decimal points", comma_,
                     has_points_ ? "would mark decimals, for which other numbers have points"
                                 : "may mark decimals or thousands");
}

bool are_numbers(std::span<const std::string> fields, char separator) {
  return std::ranges::all_of(fields, [separator](const std::string& text) {
    return DecimalMark().parse(text, separator).kind != NumberKind::kText;
  });
}

void require_apart(std::span<const std::string> headings, std::span<const std::string> wanted,
                   std::string_view place) {
  const bool together = headings.size() == 1 && wanted.size() > 1 &&
                        std::ranges::all_of(wanted, [&headings](const std::string& name) {
                          return headings.front().find(name) != std::string::npos;
                        });
  MODCAL_REQUIRE(!together,
                 "{}: \"{}\" is one column; separate columns by commas, semicolons or tabs", place,
                 headings.front());
}

std::string describe_bad_number(NumberKind kind, std::string_view text) {
  if (kind == NumberKind::kNotFinite) {
    return fmt::format(
        "\"{}\" is no usable sample; repair it, or keep only the rows before or behind it", text);
  }
  if (kind == NumberKind::kOutOfRange) {
    return fmt::format("\"{}\" is outside the range of double precision (4.9e-324 … 1.8e308)",
                       text);
  }
  if (text.empty()) return "the field is empty; every row needs a number in every column";
  const bool several = text.find_first_of(" \t") != std::string_view::npos;
  return fmt::format("\"{}\" is not a number{}", text,
                     several ? "; separate columns by commas, semicolons or tabs"
                             : "; write digits with a decimal point, such as -0.25 or 1e-3");
}

void PrintedDigits::add(std::string_view number) {
  int decimals = 0, significant = 0;
  bool after_point = false;
  std::size_t i = 0;
  for (; i < number.size() && number[i] != 'e' && number[i] != 'E'; ++i) {
    if (number[i] == '.' || number[i] == ',') {
      after_point = true;
    } else if (number[i] >= '0' && number[i] <= '9') {
      if (significant > 0 || number[i] != '0') ++significant;
      if (after_point) ++decimals;
    }
  }
  if (i < number.size()) {
    std::string_view exponent = number.substr(i + 1);
    if (exponent.starts_with('+')) exponent.remove_prefix(1);
    int value = 0;
    std::from_chars(exponent.data(), exponent.data() + exponent.size(), value);
    decimals -= value;
  }
  decimals_ = std::max(decimals_, decimals);
  significant_ = std::max(significant_, significant);
}

double PrintedDigits::resolution(double magnitude) const {
  const double fixed = std::pow(10.0, -decimals_);
  if (!(magnitude > 0.0)) return fixed;
  return std::max(fixed, std::pow(10.0, std::floor(std::log10(magnitude)) + 1 - significant_));
}

}  // namespace modcal
