// A figure as gnuplot input: a script and its data, to be kept beside the figure and edited.
#pragma once

#include <string>

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

}  // namespace modcal::report
