// Numbers with units, as people write them.
#pragma once

#include <string>
#include <string_view>

namespace modcal {

struct ScalarNumber {
  double value = 0.0;  ///< in the SI unit asked for
  std::string error;   ///< why there is no value; empty: there is one
};

/// "30 mm" in "m" is 0.03; a bare number is in the SI unit. "2 %" is allowed for pure numbers.
ScalarNumber parse_number(std::string_view text, std::string_view si_unit);

/// A leading 0 before another digit: YAML 1.1 reads 010 as 8.
bool looks_octal(std::string_view text);

}  // namespace modcal
