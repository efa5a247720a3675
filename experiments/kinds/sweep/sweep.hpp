// Kind "sweep": the same inversion over axes of settings, summed up in a table.
#pragma once

#include "experiments/kinds/invert/invert.hpp"
#include "experiments/kinds/kind_list.hpp"
#include "experiments/study/sample.hpp"

namespace modcal {

/// Outcome of one task (cell) on one side.
struct TaskScores {
  std::string side;  ///< "1", "2", "joint", …
  double parameter = 0.0;
  ChoiceStatus status = ChoiceStatus::kNotComputed;
  std::vector<WindowScore> scores;
  WindowScore whole;
  /// Mean square of what the estimate leaves of the data over that of their noise; NaN: not known.
  double misfit = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::string> warnings;
  void visit(ResultVisitor& visitor);
};

struct TaskOutcome {
  std::vector<TaskScores> sides;
  std::string failure;  ///< why the task failed; empty: it did not
  void visit(ResultVisitor& visitor);
};

/// Observes and inverts one cell. Throws InvalidInput where it cannot be done.
TaskOutcome run_cell(const InvertOptions& options, const StudyContext& context);

/// Published figures that the sweep's table is held against.
struct ComparisonOptions {
  std::string table;         ///< CSV: noise_percent, R1, epsilon1, R2, epsilon2
  double lowest_row = 0.01;  ///< rows below are shown, not judged
  double mean_difference = std::numeric_limits<double>::quiet_NaN();
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

/// How the results of a sweep are summed up.
struct SweepOptions {
  static constexpr bool kNeedsAxes = true;
  std::string name = "table";  ///< of the table's files
  bool has_comparison = false;
  ComparisonOptions comparison;
  std::vector<SweepTarget> targets;
  void visit(OptionVisitor& visitor);
};

/// A finished task with what the table sorts it by.
struct SweepTask {
  std::size_t task = 0;
  std::vector<std::string> axis_values;  ///< as written in the file
  double noise_level = 0.0;
  std::string estimator;
  /// Values on the axes of the inversion but the estimator's, which make rows of their own: ",
  /// water_level".
  std::string method;
  TaskOutcome outcome;
};

/// One row of the table: all draws of one noise level and method on one side.
struct SweepRow {
  double noise_percent = 0.0;
  std::string side;
  Sample correlation, rms_error, anti_aliased;  ///< over the short windows
  Sample whole, whole_rms_error, whole_anti_aliased;
  Sample misfit, parameter;
  std::size_t stand_ins = 0;  ///< parameters that no rule has chosen
  std::size_t warned = 0;     ///< draws whose estimate carries a warning
  std::size_t failures = 0;
  std::optional<double> published_correlation, published_parameter;
};

/// Published figures of one noise level, by side.
struct PublishedRow {
  double correlation[2];
  double parameter[2];
};
using PublishedTable = std::map<double, PublishedRow>;  ///< by noise in percent

/// Throws InvalidInput where the file is no such table.
PublishedTable read_published(const std::filesystem::path& path);

/// Rows by side and noise.
std::vector<SweepRow> sweep_rows(const std::vector<SweepTask>& tasks,
                                 const PublishedTable& published);

/// Correlation against noise: a panel a side; where several estimators are compared, every estimate
/// in one panel, for the short windows and for the long one.
report::Figure correlation_figure(const std::string& name, const std::vector<SweepRow>& rows);

/// Adds table, figure and acceptance of the finished tasks to a result that knows how many failed
/// and how many are not run yet.
void sum_up_sweep(const SweepOptions& options, const std::vector<std::string>& axes,
                  const std::vector<SweepTask>& tasks, const StudyContext& context,
                  StudyResult& result);

/// Kind "sweep": the same inversion over axes of settings, summed up in a table.
class SweepExperiment final : public AxisExperiment<InvertOptions, SweepOptions> {
 public:
  using AxisExperiment::AxisExperiment;
  std::string_view for_structures() const override {
    return "sweep repeats invert, which takes a string; for any other structure state sweep: "
           "{product: ...} in a file of kind: identify_force, fit_modes or simulate";
  }
  std::vector<Finding> lint() const override;
  std::vector<Finding> lint_records(const std::filesystem::path& folder) const override;
  std::string run_task(std::size_t task, const StudyContext& context) const override;
  std::string loss_name() const override { return "mean relative rms error of the force"; }
  std::optional<double> loss_in(const std::string& outcome) const override;
  StudyResult sum_up(const TaskOutcomes& outcomes, const StudyContext& context) const override;

 private:
  // What is wrong with figures is that there are some.
  bool is_excused(const InvertOptions& /*cell*/, const Finding& finding) const override {
    return finding.path.starts_with("figures");
  }
  void draw_all(InvertOptions& cell) const override;
};

}  // namespace modcal
