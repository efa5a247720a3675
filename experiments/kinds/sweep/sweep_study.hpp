// Kind "sweep": the same inversion over axes of settings, summed up in a table.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "experiments/kinds/invert/invert_study.hpp"
#include "experiments/kinds/sweep/sweep_outcome.hpp"

namespace modcal {

/// One cell of the sweep: its settings and their values along the axes.
struct SweepCell {
  InvertOptions options;
  std::vector<std::string> axis_values;  ///< as written in the file
  double row_value = 0.0;                ///< value of the axis that makes the table's rows
};

/// Published figures that the sweep's table is held against.
struct ComparisonOptions {
  std::string table;         ///< CSV: noise_percent, R1, epsilon1, R2, epsilon2
  double lowest_row = 0.01;  ///< rows below are shown, not judged
  double mean_difference = std::numeric_limits<double>::infinity();
  std::int64_t inside_band = 0;  ///< cells whose published R must lie within q10–q90
  double parameter_factor = 2.0;
  std::int64_t parameter_cells = 0;  ///< cells whose ε must agree within the factor
  void visit(OptionVisitor& visitor);
};

/// A figure that a row of the sweep's table has to reach.
struct SweepTarget {
  std::string side;
  double noise = 0.0;        ///< row [1]
  double correlation = 0.0;  ///< least mean over windows and draws
  double whole = 0.0;        ///< least mean over the long window
  void visit(OptionVisitor& visitor);
};

struct SweepTableOptions {
  std::string name = "table";
  void visit(OptionVisitor& visitor);
};

/// Observes and inverts one cell; a failure is an outcome.
TaskOutcome run_cell(const SweepCell& cell, const StudyContext& context);

struct SweepOptions {
  SweepTableOptions table;
  bool has_comparison = false;
  ComparisonOptions comparison;
  std::vector<SweepTarget> targets;
};

/// Table, figure and acceptance of the cells that are finished; nullopt: not run yet.
StudyResult sum_up_sweep(const SweepOptions& options, const std::vector<std::string>& axes,
                         const std::vector<SweepCell>& cells,
                         const std::vector<std::optional<TaskOutcome>>& outcomes,
                         const StudyContext& context);

}  // namespace modcal
