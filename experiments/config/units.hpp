// Units of numbers, by UDUNITS-2.
#pragma once

#include <string_view>

namespace modcal {

/// Whether `unit` measures the same dimension as `si_unit` ("mN" and "N"). False for an empty or
/// unknown unit.
bool is_unit_of(std::string_view unit, std::string_view si_unit);

/// Whether `unit` is known at all.
bool is_unit(std::string_view unit);

/// `value` `unit` in `si_unit`: to_si(3, "mN", "N") = 0.003. Throws InvalidInput where the unit is
/// unknown or of another dimension.
double to_si(double value, std::string_view unit, std::string_view si_unit);

}  // namespace modcal
