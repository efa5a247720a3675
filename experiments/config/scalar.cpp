#include "experiments/config/scalar.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

#include "experiments/config/units.hpp"

namespace modcal {

bool looks_octal(std::string_view text) {
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) text.remove_prefix(1);
  return text.size() > 1 && text[0] == '0' && text[1] >= '0' && text[1] <= '9';
}

ScalarNumber parse_number(std::string_view text, std::string_view si_unit) {
  const auto failed = [](std::string reason) { return ScalarNumber{0.0, std::move(reason)}; };
  const std::string expected =
      si_unit == "1" ? "a number"
                     : fmt::format("a number, with or without a unit such as {}", si_unit);
  if (text.empty()) return failed("there is no value: " + expected + " is needed");
  if (text[0] == '.' && text.size() > 1 && std::isalpha(static_cast<unsigned char>(text[1]))) {
    return failed(fmt::format("\"{}\" is not finite: {} is needed", text, expected));
  }
  if (looks_octal(text)) {
    return failed(fmt::format("\"{}\" looks octal: write it without the leading 0", text));
  }
  const bool plus = text[0] == '+';  // from_chars does not take it
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
  if (!is_unit_of(unit, si_unit)) {
    return failed(
        is_unit(unit)
            ? fmt::format("\"{}\" has the unit {}, which does not measure {}", text, unit,
                          si_unit == "1" ? "a pure number" : fmt::format("what {} does", si_unit))
            : fmt::format("\"{}\": {} is not a unit; {} is needed", text, unit, expected));
  }
  return {to_si(value, unit, si_unit), {}};
}

}  // namespace modcal
