// Numbers and column headings of a CSV record.
#pragma once

#include <string>
#include <string_view>

namespace modcal {

/// What a field holds. kNotFinite: "nan", "inf"; kOutOfRange: a number no double can hold.
enum class NumberKind { kNumber, kNotFinite, kOutOfRange, kText };

/// Decimal number with point, optional sign and exponent, and nothing else. `value` is NaN unless
/// the kind is kNumber (or the infinity that was written).
struct ParsedNumber {
  NumberKind kind = NumberKind::kText;
  double value = 0.0;
};
ParsedNumber parse_number(std::string_view text);

/// Why a field is no usable number and what to do about it.
std::string describe_bad_number(NumberKind kind, std::string_view text);

/// The finest decimals a column was printed with.
class PrintedDigits {
 public:
  void add(std::string_view number);
  /// Spacing of the printed numbers about `magnitude`: 10^−decimals for a fixed number of decimals,
  /// coarser for a fixed number of significant digits.
  double resolution(double magnitude) const;

 private:
  int decimals_ = 0;
  int significant_ = 1;
};

/// A heading "name [unit]" or "name (unit)"; the unit is empty where none is written.
struct ColumnHeading {
  std::string name;
  std::string unit;
};
ColumnHeading parse_heading(std::string_view text);
/// "name [unit]", or the name alone for an empty unit.
std::string heading_text(std::string_view name, std::string_view unit);

}  // namespace modcal
