// Modes of a table, as its own file states them or from the columns of a CSV file.
#pragma once

#include <filesystem>
#include <span>

#include "libsim/base/options.hpp"

namespace modcal {

/// One pair of poles of a table.
struct ModeOptions {
  double frequency = 0.0, ratio = 0.0;  ///< [Hz], [1]
  double frequency_sd = 0.0, ratio_sd = 0.0;
  std::vector<double> constants, quadrature;  ///< one a sensor; no quadrature: all are real
  void visit(OptionVisitor& visitor);
};

struct ModeColumns {
  std::vector<ModeOptions> modes;
  std::vector<double> contact;  ///< one a mode; empty: the file has no such column
};

/// A row a mode: the columns `frequency [Hz]`, `damping_ratio` and, for every sensor, one of its
/// name, the real part of the modal constant; where they are there, `NAME imaginary`,
/// `frequency_deviation`, `damping_deviation` and `contact`, as in a table's own modes. Throws
/// InvalidInput with file, line and column, also for a column that is none of these.
ModeColumns read_mode_columns(const std::filesystem::path& path,
                              std::span<const std::string> sensors);

}  // namespace modcal
