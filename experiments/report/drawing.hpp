// A figure as it is drawn: clipped to its axes, thinned to the pixels of a page, and with what was
// left out counted. The HTML page and the gnuplot scripts draw this; the CSV files hold everything.
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>

#include "experiments/report/figure.hpp"

namespace modcal::report {

/// How a series is drawn: a line, dashed or not, points, or both.
struct Look {
  bool line = true;
  bool dashed = false;
  bool points = false;
  const Ink* ink = nullptr;

  bool operator==(const Look&) const = default;
};

struct LegendEntry {
  std::string label = {};
  Look look = {};
  bool is_cell = false;  ///< a category of a map
};

struct DrawnSeries {
  const Series* source = nullptr;
  Look look = {};
  std::vector<double> x = {};
  std::vector<double> y = {};    ///< NaN: gap
  std::vector<double> low = {};  ///< empty where the series has no spread
  std::vector<double> high = {};
  std::vector<double> tasks = {};  ///< empty where no sample has a task
  bool has_values() const;
};

struct DrawnPanel {
  const Panel* source = nullptr;
  std::array<double, 2> x_window{0.0, 1.0};  ///< the axis' range, or data and markers
  /// The axis' range, or data and markers with a margin.
  std::array<double, 2> y_window{0.0, 1.0};
  /// A range or a marker asks for y_window, not the data alone: zooming in x keeps it.
  bool y_fixed = false;
  std::vector<DrawnSeries> series = {};
  std::vector<LegendEntry> legend = {};  ///< categories, then what is shown and has a label
  bool has_values() const;
};

struct DrawnFigure {
  const Figure* source = nullptr;
  std::vector<DrawnPanel> panels = {};
  /// One legend for all panels, where labels and looks belong together in all of them; empty: each
  /// panel has its own.
  std::vector<LegendEntry> legend = {};
  /// Sentences for the caption: values left out on logarithmic axes, gaps, thinned series.
  std::vector<std::string> notes = {};
};

/// `columns` ≥ 1: pixels of a panel's width that long series are thinned to. Throws InvalidInput as
/// check_figure() does. The result points into `figure`.
DrawnFigure draw_figure(const Figure& figure, std::size_t columns);

/// The figure with SI prefixes in the units of linear axes whose numbers would be long: µm, kHz.
Figure in_readable_units(Figure figure);

// Which samples of a long series are worth drawing.

/// Indices, growing, of the samples to draw when [x_0, x_last] is `columns` ≥ 1 pixels wide: in
/// every column the smallest `low`, the largest `high` and one NaN if there is any (a gap stays a
/// gap), and the first and the last sample. All samples where there are at most 4 per column on
/// average. x: monotonic (columns of equal width, in log x if `logarithmic`) or not (columns of
/// equal numbers of samples). low, high: as long as x; the samples themselves where there is no
/// spread.
std::vector<std::size_t> drawn_samples(std::span<const double> x, std::span<const double> low,
                                       std::span<const double> high, std::size_t columns,
                                       bool logarithmic);

// A figure as gnuplot input, to be kept beside the figure and edited, and drawn by it.

/// Script that reads "id.dat" and writes "id.svg" and "id.pdf" (with the text of the variable
/// `suffix`, if it is defined, behind both names).
std::string gnuplot_script(const DrawnFigure& figure);

/// One block per category of a map that has cells (middle, left, right, low, high of runs of cells)
/// and per series that has values, in the order of the script: x, y and, with a spread, its two
/// ends.
std::string gnuplot_data(const DrawnFigure& figure);

/// A single-quoted gnuplot string: nothing in it is special.
std::string gnuplot_quoted(std::string_view text);

/// Writes id.gp and id.dat of every figure into `directory` and has `program` (one process for all
/// of them) draw id.svg and id.pdf there. Returns why that failed, in words for the user; empty:
/// all files are there. Figures drawn before a failure stay. Throws
/// InvalidInput where scripts or data cannot be written.
std::string draw_with_gnuplot(std::span<const DrawnFigure> figures,
                              const std::filesystem::path& directory, const std::string& program);

struct ProcessOutcome {
  bool started = false;  ///< false: the program was not found or could not be run
  int exit_code = -1;    ///< 128 + n after signal n
  std::string output;    ///< what it wrote to stdout and stderr, or why it did not start
  bool succeeded() const { return started && exit_code == 0; }
};

/// Runs `arguments` (the program first, looked up in PATH) in `directory` with an empty stdin.
ProcessOutcome run_process(const std::vector<std::string>& arguments,
                           const std::filesystem::path& directory);

}  // namespace modcal::report
