// Colours and shapes: the one table the page, its script and gnuplot draw by.
#pragma once

#include <string_view>

#include "experiments/report/figure.hpp"

namespace modcal::report {

struct Ink {
  std::string_view name;   ///< CSS variable and class
  std::string_view light;  ///< colour on white, #rrggbb
  std::string_view dark;   ///< colour on a dark page
  std::string_view glyph;  ///< shape of its points, as a character
  std::string_view shape;  ///< the same shape in the page's script
  int gnuplot_point;       ///< and in gnuplot
};

/// Palette of Okabe and Ito (2008) without its yellow, which white paper swallows; blue is lighter
/// on a dark page.
const Ink& ink_of(ColorRole role);

}  // namespace modcal::report
