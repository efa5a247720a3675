// SVG and PDF files of a report's figures.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "experiments/report/drawing.hpp"

namespace modcal::report {

/// Writes id.gp and id.dat of every figure into `directory` and has `program` (one process for all
/// of them) draw id.svg and id.pdf there. Returns why that failed, in words for the user; empty:
/// all files are there. Figures drawn before a failure stay. Throws
/// InvalidInput where scripts or data cannot be written.
std::string draw_with_gnuplot(std::span<const DrawnFigure> figures,
                              const std::filesystem::path& directory, const std::string& program);

}  // namespace modcal::report
