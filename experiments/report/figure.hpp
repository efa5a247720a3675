// What a figure shows, as plain data: the HTML page, the gnuplot scripts and the CSV files are
// written from it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace modcal::report {

/// Meaning of a colour (and of a point's shape): the palette is that of Okabe and Ito (2008), which
/// colour-blind readers can tell apart; kReference is the ink of the page. kSeventh to kTwelfth
/// have the colours of the first six and other shapes: draw their lines dashed.
enum class ColorRole {
  kReference,
  kFirst,
  kSecond,
  kThird,
  kFourth,
  kFifth,
  kSixth,
  kMuted,
  kSeventh,
  kEighth,
  kNinth,
  kTenth,
  kEleventh,
  kTwelfth,
};
constexpr std::size_t kColorRoles = 14;

enum class SeriesStyle { kLine, kPoints, kLineWithPoints, kDashed };

/// What a reader can filter a page by: a facet ("noise") and the values under which something is
/// shown. A facet that has the value kEverything somewhere offers one value at a time, "all" first;
/// any other facet can be narrowed to some of its values.
struct Tag {
  std::string facet = {};
  std::vector<std::string> values = {};
};
using Tags = std::vector<Tag>;
inline constexpr std::string_view kEverything = "all";

/// Samples (x_i, y_i) in the units of the panel's axes. A NaN in y is a gap. The line joins the
/// samples in their order; x need not grow.
struct Series {
  std::string label = {};
  std::vector<double> x = {};
  std::vector<double> y = {};
  /// Ends of the spread about y, both empty or as long as y: a band about a line, bars at points.
  std::vector<double> y_low = {};
  std::vector<double> y_high = {};
  SeriesStyle style = SeriesStyle::kLine;
  ColorRole color = ColorRole::kFirst;
  Tags tags = {};
  /// Only a filter of the page brings it up; the files do not have it.
  bool hidden = false;
  /// Number of the task behind each sample, −1: none; empty or as long as x. The page shows the
  /// command that replays it.
  std::vector<std::int64_t> tasks = {};

  void add(double at, double value) {
    x.push_back(at);
    y.push_back(value);
  }
  void add(double at, double value, double low, double high) {
    add(at, value);
    y_low.push_back(low);
    y_high.push_back(high);
  }
};

struct Axis {
  std::string label = {};
  /// Unit as printed in brackets; "1" or empty: a pure number, no brackets.
  std::string unit = {};
  bool logarithmic = false;
  /// Shown interval {lowest, highest}; without it, what the data span.
  std::optional<std::array<double, 2>> range = {};

  /// "label [unit]".
  std::string text() const;
};

/// A dotted line across the panel at one value of an axis.
struct Marker {
  enum class Direction { kVertical, kHorizontal };
  Direction direction = Direction::kVertical;
  double value = 0.0;
  std::string label = {};
  ColorRole color = ColorRole::kReference;
};

/// One kind of cell of a map.
struct Category {
  std::string label = {};
  ColorRole color = ColorRole::kFirst;
};

/// Cells coloured by their category, beneath the series: cell (column i, row j) is
/// cells[j (x_edges.size() − 1) + i], a place in `categories` or −1 for none.
struct CategoryMap {
  std::vector<double> x_edges = {};  ///< ascending, one more than columns
  std::vector<double> y_edges = {};  ///< ascending, one more than rows
  std::vector<Category> categories = {};
  std::vector<int> cells = {};

  std::size_t columns() const { return x_edges.size() - 1; }
  std::size_t rows() const { return y_edges.size() - 1; }
};

struct Panel {
  std::string title = {};
  Axis x = {};
  Axis y = {};
  std::vector<Series> series = {};
  std::vector<Marker> markers = {};
  std::optional<CategoryMap> map = {};
};

/// Panels in reading order on a grid of `columns` columns.
struct Figure {
  std::string id = {};  ///< name of its files and anchor of its place in the page: [A-Za-z0-9_-]+
  std::string title = {};
  std::string caption = {};
  std::size_t columns = 1;
  std::vector<Panel> panels = {};
  std::string command = {};  ///< what regenerates its numbers
};

/// Throws InvalidInput where lengths differ, a range is empty or not finite, a logarithmic range is
/// not positive, a marker is not finite, the grid has no column, there is no panel, a map has not
/// one cell per column and row, edges that do not ascend or a cell without category, or the id
/// cannot be a file name.
void check_figure(const Figure& figure);

/// The series that are not hidden.
std::vector<const Series*> shown_series(const Panel& panel);

/// True for [A-Za-z0-9_-]+.
bool is_file_stem(std::string_view id);

// Colours and shapes: the one table the page, its script and gnuplot draw by.

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

/// All samples of a figure as columns: one column of x for every distinct set of abscissae, after
/// it "panel: series [unit]" (and "… low", "… high") for each series over it. Shorter columns end
/// in empty fields; a NaN is "nan". Before them stand the cells of a map, one a row: their middle
/// in x and y and their category.
std::string figure_csv(const Figure& figure);

}  // namespace modcal::report
