// A figure as gnuplot input, to be kept beside the figure and edited, and drawn by it.
#pragma once

#include <filesystem>

#include "experiments/report/drawing.hpp"

namespace modcal::report {

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
