#include "experiments/report/palette.hpp"

#include <array>

namespace modcal::report {

const Ink& ink_of(ColorRole role) {
  static constexpr std::array<Ink, kColorRoles> kInks = {{
      {"reference", "#1a1a1a", "#f0f0f0", "○", "open_circle", 6},
      {"first", "#0072b2", "#4fa8dc", "●", "circle", 7},
      {"second", "#d55e00", "#f08030", "■", "square", 5},
      {"third", "#009e73", "#2cc295", "▲", "triangle", 9},
      {"fourth", "#cc79a7", "#e095c0", "◆", "diamond", 13},
      {"fifth", "#e69f00", "#f0b030", "▼", "inverted_triangle", 11},
      {"sixth", "#56b4e9", "#86ccf2", "□", "open_square", 4},
      {"muted", "#8a8a8a", "#8f8f8f", "●", "circle", 7},
      {"seventh", "#0072b2", "#4fa8dc", "○", "open_circle", 6},
      {"eighth", "#d55e00", "#f08030", "□", "open_square", 4},
      {"ninth", "#009e73", "#2cc295", "△", "open_triangle", 8},
      {"tenth", "#cc79a7", "#e095c0", "◇", "open_diamond", 12},
      {"eleventh", "#e69f00", "#f0b030", "▽", "open_inverted_triangle", 10},
      {"twelfth", "#56b4e9", "#86ccf2", "■", "square", 5},
  }};
  return kInks.at(static_cast<std::size_t>(role));
}

}  // namespace modcal::report
