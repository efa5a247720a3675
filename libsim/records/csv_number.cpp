#include "libsim/records/csv_number.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace modcal {
namespace {

constexpr std::string_view kBlanks = " \t";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

}  // namespace

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

std::string describe_bad_number(NumberKind kind, std::string_view text) {
  if (kind == NumberKind::kNotFinite) {
    return fmt::format("\"{}\" is no usable sample; repair the record or crop it away", text);
  }
  if (kind == NumberKind::kOutOfRange) {
    return fmt::format("\"{}\" is outside the range of double precision (4.9e-324 … 1.8e308)",
                       text);
  }
  if (text.empty()) return "the field is empty; every row needs a number in every column";
  std::string with_point(text);
  std::replace(with_point.begin(), with_point.end(), ',', '.');
  if (with_point != text && parse_number(with_point).kind == NumberKind::kNumber) {
    return fmt::format("\"{}\" has a decimal comma; write a decimal point: {}", text, with_point);
  }
  const bool several = text.find_first_of(kBlanks) != std::string_view::npos;
  return fmt::format("\"{}\" is not a number{}", text,
                     several ? "; separate columns by commas, semicolons or tabs"
                             : "; write digits with a decimal point, such as -0.25 or 1e-3");
}

void PrintedDigits::add(std::string_view number) {
  int decimals = 0, significant = 0;
  bool after_point = false;
  std::size_t i = 0;
  for (; i < number.size() && number[i] != 'e' && number[i] != 'E'; ++i) {
    if (number[i] == '.') {
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

ColumnHeading parse_heading(std::string_view text) {
  text = trimmed(text);
  for (const auto& [open, close] : {std::pair('[', ']'), std::pair('(', ')')}) {
    const std::size_t start = text.rfind(open);
    if (text.ends_with(close) && start != std::string_view::npos) {
      const std::string_view unit = text.substr(start + 1, text.size() - start - 2);
      return {std::string(trimmed(text.substr(0, start))), std::string(trimmed(unit))};
    }
  }
  return {std::string(text), {}};
}

std::string heading_text(std::string_view name, std::string_view unit) {
  return unit.empty() ? std::string(name) : fmt::format("{} [{}]", name, unit);
}

}  // namespace modcal
