// Sensors whose readings fall short of large forces.
#pragma once

#include <array>
#include <optional>

#include "libinverse/waves/end_relation.hpp"

namespace modcal {

/// A sensor that reads (p/d) tanh(d R/p) of a reaction R, p its largest reading over tanh(d)/d.
struct Saturation {
  std::array<double, 2> missing{};  ///< share of the largest reaction that either lacks
  double unexplained = 0.0;         ///< share of the power that no string explains as it was read
  double mended = 0.0;              ///< and with both reactions raised to what was missing
};

/// Whether a string explains the reactions much better where one of them or both are read by such
/// sensors, at any gain of the one against the other. f₀ and x_c are those of fit_end_relations().
std::optional<Saturation> saturation_of(const EndRecord& record, StatedString string);

}  // namespace modcal
