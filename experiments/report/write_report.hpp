// Writes a report and all files beside it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "experiments/report/report.hpp"

namespace modcal::report {

struct WriteOptions {
  bool vector_figures = true;       ///< SVG and PDF by gnuplot
  std::string gnuplot = "gnuplot";  ///< looked up in PATH
};

struct WrittenReport {
  std::filesystem::path page;
  std::vector<std::filesystem::path> files;  ///< all of them, the page last
  std::string warning;                       ///< why SVG and PDF are missing; empty: they are not
};

/// Writes into `directory` (made if it is not there) report.html, ID.csv and ID.json of every table
/// and figures/ID.{csv,dat,gp,svg,pdf} of every figure, each of them under a temporary name first.
/// A report without vector figures is complete otherwise and says so. Throws InvalidInput where a
/// figure or table is malformed or two have one id (before anything is written), and where a file
/// cannot be written.
WrittenReport write_report(const Report& report, const std::filesystem::path& directory,
                           const WriteOptions& options = {});

}  // namespace modcal::report
