#include "experiments/report/csv_field.hpp"

#include <fmt/format.h>

#include <cmath>

namespace modcal::report {

std::string csv_field(std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::string csv_field(double value) { return std::isnan(value) ? "nan" : fmt::format("{}", value); }

}  // namespace modcal::report
