// Even lines of functions over frequency, to the last bit.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace modcal {

/// The lines (first + m step) times/per [Hz], m = 0, 1, …: decimals are whole numbers over a power
/// of ten, so that the third line of 0.1 Hz is 0.3; others are 3 · 0.1, which is not that, or sums.
struct EvenLines {
  double first = 0.0, step = 0.0;  ///< step 0: the lines are not even, or not known
  double times = 1.0, per = 1.0;

  double line(std::size_t m) const { return (first + static_cast<double>(m) * step) * times / per; }
  double begin() const { return first * times / per; }   ///< [Hz]
  double spacing() const { return step * times / per; }  ///< [Hz]
  std::vector<double> hertz(std::size_t count) const;
};

/// The lines from a first one and a distance [Hz] that somebody printed.
EvenLines printed_lines(double first, double step);

/// What gives all these lines [Hz] to the last bit; nothing where none does.
std::optional<EvenLines> even_lines(std::span<const double> hertz);

}  // namespace modcal
