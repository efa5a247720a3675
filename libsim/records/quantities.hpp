// Kinds of quantities: what a unit measures, and the code that universal files have for it.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace modcal {

struct Quantity {
  std::string_view kind;  ///< "acceleration"
  int code;               ///< specific data type of datasets 55 and 58
  std::string_view unit;  ///< its SI unit
  /// Exponents of length, force and temperature, in this order.
  int length, force, temperature;
};

/// Nothing for a code that is none of them (0: unknown, 1: general).
const Quantity* quantity_of_code(int code);
const Quantity* quantity_of_kind(std::string_view kind);
/// The quantity that is measured in the unit; nothing where none is.
const Quantity* quantity_of_unit(std::string_view unit);

}  // namespace modcal
