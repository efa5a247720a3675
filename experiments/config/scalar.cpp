#include "experiments/config/scalar.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <limits>

#include "libsim/base/units.hpp"

namespace modcal {
namespace {

/// The digits of a number moved by `shift` decimal places: one rounding, as if it had been written
/// in the SI unit.
double shifted(std::string_view number, int shift) {
  const std::size_t mark = number.find_first_of("eE");
  int exponent = 0;
  if (mark != std::string_view::npos) {
    std::string_view digits = number.substr(mark + 1);
    if (digits.starts_with('+')) digits.remove_prefix(1);
    std::from_chars(digits.data(), digits.data() + digits.size(), exponent);
  }
  const std::string text = fmt::format("{}e{}", number.substr(0, mark), exponent + shift);
  double value = std::numeric_limits<double>::quiet_NaN();
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  return read.ec == std::errc() ? value : std::numeric_limits<double>::quiet_NaN();
}

std::string unit_mistake(std::string_view text, std::string_view unit, std::string_view si_unit,
                         const std::string& expected) {
  if (is_unit(unit)) {
    return fmt::format("\"{}\" has the unit {}, which cannot be converted to {}: {} is needed",
                       text, unit, si_unit == "1" ? "a pure number" : si_unit, expected);
  }
  const std::string nearest = nearest_unit(unit, si_unit);
  return fmt::format("\"{}\": {} is not a unit{}; {} is needed", text, unit,
                     nearest.empty() ? "" : fmt::format(", did you mean \"{}\"?", nearest),
                     expected);
}

}  // namespace

bool looks_octal(std::string_view text) {
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) text.remove_prefix(1);
  return text.size() > 1 && text[0] == '0' && text[1] >= '0' && text[1] <= '9';
}

ScalarNumber parse_number(std::string_view text, std::string_view si_unit) {
  const auto failed = [](std::string reason) { return ScalarNumber{0.0, std::move(reason)}; };
  const std::string expected =
      si_unit == "1" ? "a number"
                     : fmt::format("a number in {}, such as {},", si_unit, unit_example(si_unit));
  if (text.empty()) return failed("there is no value: " + expected + " is needed");
  if (text[0] == '.' && text.size() > 1 && std::isalpha(static_cast<unsigned char>(text[1]))) {
    return failed(fmt::format("\"{}\" is not finite: {} is needed", text, expected));
  }
  if (looks_octal(text)) {
    return failed(fmt::format("\"{}\" looks octal: write it without the leading 0", text));
  }
  // from_chars does not take a plus.
  const bool plus = text[0] == '+' && text.size() > 1 && text[1] != '-';
  const char* begin = text.data() + (plus ? 1 : 0);
  const char* last = text.data() + text.size();
  double value = 0.0;
  const auto [end, error] = std::from_chars(begin, last, value);
  if (error == std::errc::result_out_of_range) {
    return failed(fmt::format("\"{}\" is beyond the range of numbers", text));
  }
  if (error != std::errc() || !std::isfinite(value)) {
    return failed(fmt::format("\"{}\" is not a number: {} is needed", text, expected));
  }
  std::string_view unit(end, static_cast<std::size_t>(last - end));
  while (!unit.empty() && unit.front() == ' ') unit.remove_prefix(1);
  if (unit.empty()) return {value, {}};
  if (unit.front() == ',') {
    return failed(fmt::format("\"{}\": write a decimal point, not a comma", text));
  }
  const auto scale = unit_scale(unit, si_unit);
  if (!scale) return failed(unit_mistake(text, unit, si_unit, expected));
  const double si =
      scale->decimal_exponent
          ? shifted({begin, static_cast<std::size_t>(end - begin)}, *scale->decimal_exponent)
          : scale->factor * value + scale->offset;
  if (!std::isfinite(si)) return failed(fmt::format("\"{}\" is beyond the range of numbers", text));
  return {si, {}};
}

}  // namespace modcal
