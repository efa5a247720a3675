// Kind "sweep": the same inversion over axes of settings, summed up in a table.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "experiments/kinds/invert_study.hpp"

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

struct SweepTableOptions {
  std::string name = "table";
  void visit(OptionVisitor& visitor);
};

/// Outcome of one task (cell) on one side.
struct TaskScores {
  End end = End::kLeft;
  double parameter = 0.0;
  ChoiceStatus status = ChoiceStatus::kNotComputed;
  std::vector<WindowScore> scores;
};

struct TaskOutcome {
  std::vector<TaskScores> sides;
  std::string failure;  ///< why the task failed; empty: it did not
};

/// Runs every cell, over threads; the results stand in the order of the cells whatever the threads.
std::vector<TaskOutcome> run_cells(const std::vector<SweepCell>& cells,
                                   const StudyContext& context);

struct SweepOptions {
  SweepTableOptions table;
  bool has_comparison = false;
  ComparisonOptions comparison;
};

/// Table, figure and acceptance of finished cells.
StudyResult sum_up_sweep(const SweepOptions& options, const std::vector<std::string>& axes,
                         const std::vector<SweepCell>& cells,
                         const std::vector<TaskOutcome>& outcomes, const StudyContext& context);

}  // namespace modcal
