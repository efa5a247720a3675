// Units as people read them: 200 µm and 20 kHz, where the data have 2×10⁻⁴ m and 20000 Hz.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>

#include "experiments/report/drawing.hpp"

namespace modcal::report {
namespace {

struct Prefix {
  const char* name;
  double factor;
};
constexpr Prefix kPrefixes[] = {{"n", 1e-9}, {"µ", 1e-6}, {"m", 1e-3},
                                {"k", 1e3},  {"M", 1e6},  {"G", 1e9}};

// Whether a prefix may stand before it: its first factor is a plain unit without an exponent.
bool takes_prefix(std::string_view unit) {
  const std::string_view first = unit.substr(0, unit.find_first_of("/ "));
  constexpr std::string_view kPlain[] = {"m", "s", "Hz", "N", "W", "J", "V", "Pa"};
  return std::find(std::begin(kPlain), std::end(kPlain), first) != std::end(kPlain);
}

// What the axes of one quantity show.
struct Shown {
  double least = std::numeric_limits<double>::infinity();  ///< size of the smallest lower end
  double largest = 0.0;

  void add(const std::array<double, 2>& window) {
    least = std::min(least, std::abs(window[0]));
    largest = std::max({largest, std::abs(window[0]), std::abs(window[1])});
  }
  // A spectrum is read in kHz, the neighbourhood of one mode in Hz.
  bool is_spectrum(std::string_view unit) const {
    constexpr std::string_view kFrequency = "Hz";
    return unit == kFrequency && largest >= 2000.0 && least <= 0.1 * largest;
  }
};

/// Null: the numbers are short as they are.
const Prefix* prefix_for(const Shown& shown, std::string_view unit) {
  const double largest = shown.largest;
  const bool is_short = largest == 0.0 || (largest >= 0.01 && largest < 1e4);
  if (is_short && !shown.is_spectrum(unit)) return nullptr;
  const Prefix* best = nullptr;
  for (const Prefix& prefix : kPrefixes) {
    if (prefix.factor <= largest) best = &prefix;
  }
  return best;
}

void scale(std::vector<double>& values, double factor) {
  for (double& value : values) value /= factor;
}

void scale_range(Axis& axis, const Prefix& prefix) {
  axis.unit = prefix.name + axis.unit;
  if (axis.range)
    *axis.range = {(*axis.range)[0] / prefix.factor, (*axis.range)[1] / prefix.factor};
}

void scale_markers(Panel& panel, Marker::Direction direction, double factor) {
  for (Marker& marker : panel.markers) {
    if (marker.direction == direction) marker.value /= factor;
  }
}

void scale_x(Panel& panel, const Prefix& prefix) {
  scale_range(panel.x, prefix);
  scale_markers(panel, Marker::Direction::kVertical, prefix.factor);
  for (Series& series : panel.series) scale(series.x, prefix.factor);
  if (panel.map) scale(panel.map->x_edges, prefix.factor);
}

void scale_y(Panel& panel, const Prefix& prefix) {
  scale_range(panel.y, prefix);
  scale_markers(panel, Marker::Direction::kHorizontal, prefix.factor);
  for (Series& series : panel.series) {
    for (auto* values : {&series.y, &series.y_low, &series.y_high}) scale(*values, prefix.factor);
  }
  if (panel.map) scale(panel.map->y_edges, prefix.factor);
}

// m/s2 as m/s².
std::string with_exponents(std::string_view unit) {
  std::string text;
  for (std::size_t i = 0; i < unit.size(); ++i) {
    const bool follows = i > 0 && std::isalpha(static_cast<unsigned char>(unit[i - 1])) != 0;
    if (follows && (unit[i] == '2' || unit[i] == '3')) {
      text += unit[i] == '2' ? "²" : "³";
    } else {
      text += unit[i];
    }
  }
  return text;
}

}  // namespace

Figure in_readable_units(Figure figure) {
  // Panels with the same quantity keep the same unit.
  std::map<std::string, Shown> shown;
  const DrawnFigure drawn = draw_figure(figure, 1);
  for (const DrawnPanel& panel : drawn.panels) {
    shown[panel.source->x.text()].add(panel.x_window);
    shown[panel.source->y.text()].add(panel.y_window);
  }
  for (Panel& panel : figure.panels) {
    const auto prefix_of = [&shown](const Axis& axis) {
      return takes_prefix(axis.unit) ? prefix_for(shown[axis.text()], axis.unit) : nullptr;
    };
    const Prefix* x = prefix_of(panel.x);
    const Prefix* y = prefix_of(panel.y);
    if (x != nullptr) scale_x(panel, *x);
    if (y != nullptr) scale_y(panel, *y);
    for (Axis* axis : {&panel.x, &panel.y}) axis->unit = with_exponents(axis->unit);
  }
  return figure;
}

}  // namespace modcal::report
