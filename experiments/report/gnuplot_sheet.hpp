// Where titles, legends and labels of a printed figure stand. gnuplot's own key knows neither the
// title beside it nor the width of its panel, so they are placed here, by the widths of their
// letters, and get the height they need.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/report/drawing.hpp"

namespace modcal::report {

/// A rectangle of the sheet [in], from its left lower corner.
struct Frame {
  double left = 0.0, right = 0.0, bottom = 0.0, top = 0.0;
  double width() const { return right - left; }
  double height() const { return top - bottom; }
};

/// A legend's entry at its place: the middle of its text's left end.
struct PlacedEntry {
  LegendEntry entry = {};
  double x = 0.0, y = 0.0;
};

/// A text and where it begins, or the middle of it.
struct PlacedText {
  std::string text = {};
  double x = 0.0, y = 0.0;
};

/// The sheet of a figure, its panels in rows.
class PrintSheet {
 public:
  explicit PrintSheet(const DrawnFigure& figure);

  double width() const { return width_; }
  double height() const { return height_; }
  /// Axes of a panel, without what is written around them.
  Frame plot_of(std::size_t panel) const;
  /// Lines of the panel's title.
  std::vector<PlacedText> title_of(std::size_t panel) const;
  /// The legend above the panel; the first panel brings that of all.
  std::vector<PlacedEntry> legend_of(std::size_t panel) const;
  /// Labels of markers: of vertical ones above the axes (x: their middle), of horizontal ones in
  /// the right margin (x: where they begin). One a marker, empty where it is not shown.
  std::vector<PlacedText> marker_labels_of(std::size_t panel) const;

  static constexpr double kSample = 0.24;  ///< [in] of line before a legend's text
  static constexpr double kGap = 0.06;     ///< [in] between the two

 private:
  Frame panel_of(std::size_t panel) const;
  double text_right(std::size_t panel) const;
  std::vector<PlacedEntry> flow(const std::vector<LegendEntry>& entries, double left, double right,
                                double top) const;
  std::vector<PlacedEntry> own_legend(std::size_t panel) const;
  std::vector<PlacedText> upright_labels(std::size_t panel) const;
  std::vector<PlacedText> level_labels(std::size_t panel) const;

  const DrawnFigure& figure_;
  std::size_t columns_ = 1, rows_ = 1;
  bool shared_ = false;  ///< one legend above all panels
  double panel_width_ = 0.0, panel_height_ = 0.0, plot_height_ = 0.0;
  double right_margin_ = 0.0;
  std::size_t title_lines_ = 0, legend_lines_ = 0, label_lines_ = 0;
  double shared_legend_ = 0.0;  ///< height of the legend of all panels
  double width_ = 0.0, height_ = 0.0;
};

/// Width [in] of a text in the font of printed figures, rather too large than too small.
double printed_width(std::string_view text);

/// Whether a value stands within the window, and at which share of it.
bool is_within(const std::array<double, 2>& window, double value);
double share_in(const std::array<double, 2>& window, double value, bool logarithmic);

/// Distance of the tics of a linear axis `length` [in] long: 1, 2 or 5 times a power of ten, the
/// smallest one at which there are not more than `most` and their labels stay apart. `upright`: the
/// labels stand one above the other.
double tic_step(const std::array<double, 2>& window, double length, double most, bool upright);

/// Entries of a panel's legend that have something to show.
std::vector<LegendEntry> printed_legend(const DrawnPanel& panel);

/// Whether a category of a map has a cell.
bool has_cells(const CategoryMap& map, std::size_t category);

}  // namespace modcal::report
