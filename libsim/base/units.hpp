// Units of numbers that people write: the only door to UDUNITS-2.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace modcal {

/// What one unit is worth in an SI unit of the same dimension: si = factor · value + offset.
struct UnitScale {
  double factor = 1.0;
  double offset = 0.0;
  /// k where the factor is 10^k and there is no offset: shifting the decimal exponent of a written
  /// number is then exact, where a product would round once more.
  std::optional<int> decimal_exponent;
};

/// Whether the text is a unit at all ("mm", "kg/m", "m s-1", "%"), of whatever dimension.
bool is_unit(std::string_view unit);

/// Scale of `unit` in `si_unit`; nothing where it is unknown or of another dimension. The
/// reciprocal dimension (s for Hz) and angles (rad/s for Hz), which UDUNITS-2 also converts, are
/// other dimensions here: 1 rad/s is 1/2π Hz. Throws InvalidInput where the unit database is
/// missing.
std::optional<UnitScale> unit_scale(std::string_view unit, std::string_view si_unit);

/// Whether `unit` measures the same dimension as `si_unit` ("mN" and "N"). False for an empty or
/// unknown unit.
bool is_unit_of(std::string_view unit, std::string_view si_unit);

/// `value` `unit` in `si_unit`: to_si(3, "mN", "N") = 0.003. Throws InvalidInput where the unit is
/// unknown or of another dimension.
double to_si(double value, std::string_view unit, std::string_view si_unit);

/// The usual unit of the same dimension that is spelled most like `unit`; empty where none is near.
std::string nearest_unit(std::string_view unit, std::string_view si_unit);

/// A number with a unit as an example of how to write one ("30 mm" for "m").
std::string unit_example(std::string_view si_unit);

}  // namespace modcal
