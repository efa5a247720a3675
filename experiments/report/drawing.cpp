#include "experiments/report/drawing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace modcal::report {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct LeftOut {
  std::size_t non_positive = 0;
  std::size_t not_finite = 0;
  std::size_t clipped_ends = 0;
  std::size_t thinned_from = 0;
  std::size_t thinned_to = 0;
};

// A value as it can be drawn on the axis, else NaN and counted.
double drawable(double value, const Axis& axis, LeftOut& left_out) {
  if (!std::isfinite(value)) {
    ++left_out.not_finite;
    return kNaN;
  }
  if (axis.logarithmic && value <= 0.0) {
    ++left_out.non_positive;
    return kNaN;
  }
  return value;
}

// End of a spread: an end that is missing is at y, one that a logarithmic axis cannot show is
// marked with 0 and moved later.
double drawable_end(double end, double y, const Axis& axis, LeftOut& left_out) {
  if (std::isnan(y)) return kNaN;
  if (!std::isfinite(end)) {
    ++left_out.not_finite;
    return y;
  }
  if (axis.logarithmic && end <= 0.0) {
    ++left_out.clipped_ends;
    return 0.0;
  }
  return end;
}

// Moves the ends marked with 0 to the lowest value the series has.
void raise_marked_ends(DrawnSeries& drawn) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const auto* values : {&drawn.y, &drawn.low}) {
    for (const double value : *values) {
      if (value > 0.0) lowest = std::min(lowest, value);
    }
  }
  for (auto* values : {&drawn.low, &drawn.high}) {
    for (double& value : *values) {
      if (value == 0.0) value = lowest;
    }
  }
}

Look look_of(const Series& series) {
  const bool points = series.style == SeriesStyle::kPoints;
  return {.line = !points,
          .dashed = series.style == SeriesStyle::kDashed,
          .points = points || series.style == SeriesStyle::kLineWithPoints,
          .ink = &ink_of(series.color)};
}

bool inside(double x, const Axis& axis) {
  return !axis.range || (x >= (*axis.range)[0] && x <= (*axis.range)[1]);
}

// Samples within the range of x and their neighbours, so that lines run on to the frame.
DrawnSeries clipped(const Series& series, const Panel& panel, LeftOut& left_out) {
  DrawnSeries drawn{.source = &series,
                    .look = look_of(series),
                    .x = {},
                    .y = {},
                    .low = {},
                    .high = {},
                    .tasks = {}};
  const std::size_t n = series.x.size();
  const bool has_spread = !series.y_low.empty();
  for (std::size_t i = 0; i < n; ++i) {
    const bool shown = inside(series.x[i], panel.x) ||
                       (i > 0 && inside(series.x[i - 1], panel.x)) ||
                       (i + 1 < n && inside(series.x[i + 1], panel.x));
    if (!shown) continue;
    const double x = drawable(series.x[i], panel.x, left_out);
    if (std::isnan(x)) continue;
    const double y = drawable(series.y[i], panel.y, left_out);
    drawn.x.push_back(x);
    drawn.y.push_back(y);
    if (!series.tasks.empty()) drawn.tasks.push_back(static_cast<double>(series.tasks[i]));
    if (!has_spread) continue;
    drawn.low.push_back(drawable_end(series.y_low[i], y, panel.y, left_out));
    drawn.high.push_back(drawable_end(series.y_high[i], y, panel.y, left_out));
  }
  if (panel.y.logarithmic && has_spread) raise_marked_ends(drawn);
  return drawn;
}

std::vector<double> picked(const std::vector<double>& values,
                           const std::vector<std::size_t>& indices) {
  if (values.empty()) return {};
  std::vector<double> result;
  result.reserve(indices.size());
  for (const std::size_t i : indices) result.push_back(values[i]);
  return result;
}

void thin(DrawnSeries& drawn, const Panel& panel, std::size_t columns, LeftOut& left_out) {
  const auto& low = drawn.low.empty() ? drawn.y : drawn.low;
  const auto& high = drawn.high.empty() ? drawn.y : drawn.high;
  if (drawn.x.empty()) return;
  const auto kept = drawn_samples(drawn.x, low, high, columns, panel.x.logarithmic);
  if (kept.size() == drawn.x.size()) return;
  left_out.thinned_from += drawn.x.size();
  left_out.thinned_to += kept.size();
  for (auto* values : {&drawn.x, &drawn.y, &drawn.low, &drawn.high, &drawn.tasks}) {
    *values = picked(*values, kept);
  }
}

struct Extent {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void add(double value) {
    if (std::isnan(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  bool empty() const { return low > high; }
  /// No wider than rounding: the ten digits written of an axis' ends must tell them apart.
  bool one_value() const { return high - low <= 1e-8 * std::max(std::abs(low), std::abs(high)); }
};

// The extent with a margin of `share` of its width on both sides.
std::array<double, 2> widened(const Extent& extent, double share, bool logarithmic) {
  if (extent.empty()) return logarithmic ? std::array{1.0, 10.0} : std::array{0.0, 1.0};
  if (logarithmic) {
    const double ratio = extent.one_value() ? 10.0 : extent.high / extent.low;
    const double margin = std::pow(ratio, extent.one_value() ? 0.5 : share);
    return {extent.low / margin, extent.high * margin};
  }
  if (extent.one_value()) {
    const double margin = extent.low == 0.0 ? 1.0 : std::abs(extent.low) / 10.0;
    return {extent.low - margin, extent.high + margin};
  }
  const double margin = share * (extent.high - extent.low);
  return {extent.low - margin, extent.high + margin};
}

std::array<double, 2> x_window_of(const DrawnPanel& drawn) {
  const Panel& panel = *drawn.source;
  if (panel.x.range) return *panel.x.range;
  if (panel.map) return {panel.map->x_edges.front(), panel.map->x_edges.back()};
  Extent extent;
  bool has_points = false;
  for (const DrawnSeries& series : drawn.series) {
    for (const double x : series.x) extent.add(x);
    has_points = has_points || series.source->style == SeriesStyle::kPoints ||
                 series.source->style == SeriesStyle::kLineWithPoints;
  }
  for (const Marker& marker : panel.markers) {
    if (marker.direction == Marker::Direction::kVertical) extent.add(marker.value);
  }
  // Points on the frame would be cut in halves.
  return widened(extent, has_points ? 0.03 : 0.0, panel.x.logarithmic);
}

void set_y_window(DrawnPanel& drawn) {
  const Panel& panel = *drawn.source;
  if (panel.map) {
    drawn.y_fixed = true;
    drawn.y_window =
        panel.y.range.value_or(std::array{panel.map->y_edges.front(), panel.map->y_edges.back()});
    return;
  }
  Extent data;
  for (const DrawnSeries& series : drawn.series) {
    if (series.source->hidden) continue;
    for (const auto* values : {&series.y, &series.low, &series.high}) {
      for (const double value : *values) data.add(value);
    }
  }
  Extent all = data;
  for (const Marker& marker : panel.markers) {
    if (marker.direction == Marker::Direction::kHorizontal) all.add(marker.value);
  }
  drawn.y_fixed = panel.y.range || all.low != data.low || all.high != data.high;
  drawn.y_window = panel.y.range ? *panel.y.range : widened(all, 0.05, panel.y.logarithmic);
}

std::vector<LegendEntry> legend_of(const Panel& panel) {
  std::vector<LegendEntry> legend;
  for (const Category& category : panel.map ? panel.map->categories : std::vector<Category>{}) {
    legend.push_back(
        {.label = category.label, .look = {.ink = &ink_of(category.color)}, .is_cell = true});
  }
  for (const Series* series : shown_series(panel)) {
    if (!series->label.empty()) legend.push_back({series->label, look_of(*series)});
  }
  return legend;
}

// Of several panels, where one repeats what another one shows and no label has two looks, no look
// two labels.
std::vector<LegendEntry> common_legend(const std::vector<DrawnPanel>& panels) {
  if (panels.size() == 1) return panels.front().legend;
  std::vector<LegendEntry> common;
  bool repeats = false;
  for (const DrawnPanel& panel : panels) {
    if (panel.source->map) return {};
    for (const LegendEntry& entry : panel.legend) {
      const auto known = std::ranges::find_if(common, [&](const LegendEntry& other) {
        return other.label == entry.label || other.look == entry.look;
      });
      if (known == common.end()) {
        common.push_back(entry);
      } else if (known->label == entry.label && known->look == entry.look) {
        repeats = true;
      } else {
        return {};
      }
    }
  }
  return repeats ? common : std::vector<LegendEntry>{};
}

std::string counted(std::size_t count, std::string_view one, std::string_view many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::vector<std::string> notes_on(const LeftOut& left_out) {
  std::vector<std::string> notes;
  if (left_out.non_positive > 0) {
    notes.push_back(counted(left_out.non_positive, "value", "values") +
                    " ≤ 0 left out: a logarithmic axis cannot show them.");
  }
  if (left_out.clipped_ends > 0) {
    notes.push_back(counted(left_out.clipped_ends, "end", "ends") +
                    " of error bars at or below 0 drawn at the lowest value of the series.");
  }
  if (left_out.not_finite > 0) {
    notes.push_back(counted(left_out.not_finite, "value is", "values are") +
                    " not finite and drawn as gaps.");
  }
  if (left_out.thinned_from > 0) {
    notes.push_back(fmt::format(
        "Long series are drawn by their extremes in every pixel column ({} of {} samples); the CSV "
        "file holds all.",
        left_out.thinned_to, left_out.thinned_from));
  }
  return notes;
}

}  // namespace

bool DrawnSeries::has_values() const {
  return std::any_of(y.begin(), y.end(), [](double value) { return !std::isnan(value); });
}

bool DrawnPanel::has_values() const {
  if (source->map) return true;
  return std::any_of(series.begin(), series.end(),
                     [](const DrawnSeries& drawn) { return drawn.has_values(); });
}

DrawnFigure draw_figure(const Figure& figure, std::size_t columns) {
  check_figure(figure);
  DrawnFigure result{.source = &figure};
  LeftOut left_out;
  for (const Panel& panel : figure.panels) {
    DrawnPanel drawn{.source = &panel, .legend = legend_of(panel)};
    LeftOut not_seen;  // of hidden series: the caption speaks of what is shown
    for (const Series& series : panel.series) {
      LeftOut& counted = series.hidden ? not_seen : left_out;
      drawn.series.push_back(clipped(series, panel, counted));
      thin(drawn.series.back(), panel, columns, counted);
    }
    drawn.x_window = x_window_of(drawn);
    set_y_window(drawn);
    result.panels.push_back(std::move(drawn));
  }
  result.legend = common_legend(result.panels);
  result.notes = notes_on(left_out);
  return result;
}

}  // namespace modcal::report
