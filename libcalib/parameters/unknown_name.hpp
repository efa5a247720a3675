// Names of what a calibration may find or be told of a string and its sensors.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace modcal {

enum class UnknownKind {
  kFundamental,    ///< f0 [Hz]
  kInharmonicity,  ///< B [1]
  kContact,        ///< x_c [m]
  kFrequency,      ///< f_n [Hz]
  kDampingRatio,   ///< zeta_n [1]
  kDampingFactor,  ///< damping: factor of all stated ζ_n [1], that of ζ_1 where there is a power
  kDampingPower,   ///< damping_power: exponent p of n in ζ_n = factor nᵖ ζ_n(stated) [1]
  kGain,           ///< gain [1]
  kDelay,          ///< delay [s]
  kCorner          ///< corner [Hz]
};

struct UnknownName {
  UnknownKind kind = UnknownKind::kFundamental;
  std::size_t mode = 0;    ///< index, of f_n and zeta_n
  std::size_t record = 0;  ///< index: "x_c" and "x_c 1" are the first record's, "x_c 2" the next
  bool operator==(const UnknownName&) const = default;
};

/// "f0", "B", "x_c", "f_3", "zeta_3", "damping", "damping_power", "gain", "delay", "corner", with
/// the number of a record behind where that is not the first; none for other text.
std::optional<UnknownName> parse_unknown(std::string_view text);
/// The same for a string of so many modes. Throws InvalidInput for other text and other modes.
UnknownName require_unknown(std::string_view text, std::size_t modes);
/// SI unit of its values; "1" for other text.
std::string_view unit_of_unknown(std::string_view text);
/// What it is, in words; empty for other text.
std::string_view meaning_of_unknown(std::string_view text);
/// Whether its values are > 0: its prior acts on the logarithm.
bool is_positive(UnknownKind kind);

}  // namespace modcal
