// Kind "benchmark": calibrations over objectives, optimizers and data, scored on the truth and held
// against what the data allow at best.
#pragma once

#include "experiments/kinds/axis_experiment.hpp"
#include "experiments/kinds/calibrate/calibrate.hpp"
#include "experiments/study/sample.hpp"

namespace modcal {

/// Cramér–Rao bounds of the modal frequencies, computed once for each scene, noise level and set of
/// unknowns. Safe to use from several threads.
class FrequencyBounds {
 public:
  using Bounds = std::shared_ptr<const std::vector<double>>;
  /// Relative standard deviation of f_1 … f_N that no unbiased estimate of both reactions with the
  /// force unknown goes below, damping and sensors free as far as they are calibrated: of the
  /// stiff-string law where it is free (x_c known unless it is calibrated), of every frequency
  /// under the law prior and what priors are stated where frequencies are free. Null
  /// without noise or where no frequency is free. Throws InvalidInput as expected_limit() does.
  Bounds of(const CalibrateOptions& options, TruthCache& truths);

 private:
  ComputedOnce<Bounds> known_;
};

/// √(mean of b_n²) over the modes n listed; NaN for null bounds or no mode.
double rms_bound(const FrequencyBounds::Bounds& bounds, const std::vector<std::size_t>& modes);

/// When a calibration counts as successful.
struct SuccessOptions {
  static constexpr bool kNeedsAxes = true;
  double frequency_error = 1e-3;  ///< largest median |f_n − true|/true over excited modes
  double contact_error = 1e-4;    ///< largest |x_c − true| [m], where x_c is free
  void visit(OptionVisitor& visitor);
};

/// Outcome of one task: a calibration scored on the truth.
struct BenchmarkOutcome {
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

  /// Why there is no calibration (refused, broken); empty: there is one.
  std::string failure;
  StopReason stop = StopReason::kNotRun;
  std::int64_t evaluations = 0;
  double initial_value = kNan;  ///< of the objective
  double value = kNan;          ///< at the end
  double truth_value = kNan;    ///< at the true model
  double initial_error = kNan;
  /// Median of |f_n − true|/true over the modes that the contact excites.
  double frequency_error = kNan;
  double frequency_rms_error = kNan;  ///< over the same modes
  /// Cramér–Rao bound of frequency_rms_error; NaN without noise.
  double frequency_bound = kNan;
  double contact_error = kNan;  ///< |x_c − true| [m]
  /// Mean correlation of identified and true force over sides and windows.
  double correlation = kNan;
  bool success = false;
  /// Evaluations so far and best value, at the improvements; thinned to 100.
  std::vector<std::pair<std::int64_t, double>> trace;

  /// frequency_rms_error over its bound; NaN without a bound.
  double bound_ratio() const { return frequency_rms_error / frequency_bound; }
  void visit(ResultVisitor& visitor);
  /// What is there unless the task failed: the store and tasks.csv have it.
  void visit_scores(ResultVisitor& visitor);
};

/// Why a task did not succeed, in words that can be counted; empty where it did.
std::string reason_of(const BenchmarkOutcome& outcome);

/// Calibrates one cell and scores it. Noise, model errors and truth depend on the cell's seed and
/// scene alone: every optimizer sees the same. Throws Interrupted, and InvalidInput where there is
/// no calibration.
BenchmarkOutcome run_benchmark_cell(const CalibrateOptions& options, const SuccessOptions& success,
                                    FrequencyBounds& bounds, const StudyContext& context);

// Outcomes of a benchmark by method and condition.

/// What a task is compared by.
struct BenchmarkLabels {
  std::string objective;  ///< "force_mismatch"
  std::string search;     ///< what else tells methods apart: "nlopt LN_SBPLX"
  std::string condition;  ///< what differs in the data, but for the seed: "noise 5 %"
  std::string replicate;  ///< what tells draws of one condition apart: the seed
  std::string method() const { return search + ", " + objective; }
};

/// One finished task of a benchmark.
struct BenchmarkTask {
  std::size_t task = 0;
  std::size_t method = 0;     ///< index: what differs in the calibration
  std::size_t condition = 0;  ///< index: what differs in the data, but for the seed
  std::string replicate;      ///< what tells draws of one condition apart: the seed
  double seconds = 0.0;
  BenchmarkOutcome outcome;
};

/// A benchmark as a grid of methods and conditions.
struct BenchmarkGrid {
  std::vector<std::string> methods;     ///< "nlopt LN_SBPLX, force_mismatch"
  std::vector<std::string> objectives;  ///< of the methods: "force_mismatch"
  std::vector<std::string> searches;    ///< what else tells methods apart: "nlopt LN_SBPLX"
  std::vector<std::string> conditions;  ///< "5 %"
  std::vector<double> noise_levels;     ///< of the conditions [1]
  std::vector<BenchmarkTask> tasks;
};

/// Share of successes with its 95 % interval (Wilson, 1927).
struct SuccessShare {
  double share = 0.0, low = 0.0, high = 0.0;
};
SuccessShare success_share(std::size_t successes, std::size_t n);

/// All draws of one method under one condition.
struct BenchmarkCell {
  std::size_t method = 0;
  std::size_t condition = 0;
  std::size_t n = 0;
  std::size_t successes = 0;
  std::size_t failures = 0;  ///< refused or broke: without any estimate
  SuccessShare success;
  Spread error;                ///< median error of the frequencies; failures left out
  Spread rms;                  ///< rms error of the frequencies
  double rmse = 0.0;           ///< over all modes and draws with an estimate
  double bound = 0.0;          ///< Cramér–Rao bound of rmse; NaN without noise
  double bound_ratio = 0.0;    ///< rmse / bound
  double contact_error = 0.0;  ///< median [m]
  double correlation = 0.0;    ///< median
  double evaluations = 0.0;    ///< median
  double seconds = 0.0;        ///< median
  /// 1 + number of methods that are better beyond doubt under this condition; methods that cannot
  /// be told apart share a rank.
  std::size_t rank = 0;
  /// What most of the draws without success had in common; empty where all succeeded.
  std::string reason;
  std::size_t reason_count = 0;
  std::int64_t task = -1;  ///< the draw with the median error; −1: none has an estimate
};

/// Cells by condition, then method. Ranks compare medians of the frequency error over the draws
/// that two methods share, a draw without an estimate being worse than any other: a method is
/// better where the 95 % interval of the ratio of medians (median_ratio) lies below 1.
std::vector<BenchmarkCell> benchmark_cells(const BenchmarkGrid& grid);

/// Place of a value among others; their number where it is none of them.
std::size_t place_in(const std::vector<std::string>& values, const std::string& value);

/// Distinct values in the order of their first use.
std::vector<std::string> distinct(const std::vector<std::string>& values);

/// "{type: nlopt, algorithm: LN_SBPLX}" → "nlopt LN_SBPLX".
std::string short_label(const std::string& value);

using CellOptions = std::function<CalibrateOptions(std::size_t task)>;

/// Warnings where methods have different budgets, bounds, starts, noise or problems, where there
/// are fewer than 10 draws to rank them by, and where a search does not come half the way to the
/// minimum of a parabola of as many variables within its budget, though it could with twenty times
/// as much.
std::vector<Finding> lint_fairness(const std::vector<BenchmarkLabels>& tasks,
                                   const CellOptions& options_of);

// What a benchmark shows: table, conclusion, figures.

/// One row a method and condition.
report::Table benchmark_table(const BenchmarkGrid& grid, const std::vector<BenchmarkCell>& cells);
/// Heat map of the share of successes: one row a method, one column a condition.
report::Table success_map(const BenchmarkGrid& grid, const std::vector<BenchmarkCell>& cells);
/// Heat map of the frequency RMSE over the Cramér–Rao bound; no rows where there is no bound.
report::Table bound_map(const BenchmarkGrid& grid, const std::vector<BenchmarkCell>& cells);
/// Which methods to use: a sentence for as many neighbouring conditions as one of the best methods
/// serves.
std::vector<std::string> recommendations(const BenchmarkGrid& grid,
                                         const std::vector<BenchmarkCell>& cells);
/// Which methods fail, where and why.
std::vector<std::string> failing_methods(const BenchmarkGrid& grid,
                                         const std::vector<BenchmarkCell>& cells);
/// Cells of one condition, best first; equals in the order of the methods.
std::vector<const BenchmarkCell*> ranked_cells(const std::vector<BenchmarkCell>& cells,
                                               std::size_t condition);
/// "20 draws", "18 to 20 draws": of a method under a condition.
std::string draws_text(const BenchmarkGrid& grid);

/// RMS frequency error against noise with the band from 10 % to 90 % of the draws and the
/// Cramér–Rao bound. Like the other figures: a panel an objective, tags for the page's filters, the
/// number of a task behind each point.
report::Figure error_figure(const BenchmarkGrid& grid, const std::vector<BenchmarkCell>& cells);
/// Share of tasks solved against evaluations spent (data profile: Moré and Wild, 2009, with success
/// judged on the truth).
report::Figure data_profile(const BenchmarkGrid& grid);
/// Share of problems solved within a factor of the evaluations of the fastest method (performance
/// profile: Dolan and Moré, 2002).
report::Figure performance_profile(const BenchmarkGrid& grid);
/// Median error against median time, one point a method and condition.
report::Figure work_precision_figure(const BenchmarkGrid& grid,
                                     const std::vector<BenchmarkCell>& cells);
/// Final errors of all draws in rising order (waterfall).
report::Figure waterfall_figure(const BenchmarkGrid& grid);
/// Best value so far above that at the truth, first draw of each condition.
report::Figure trace_figure(const BenchmarkGrid& grid);

// What the figures have in common: a panel an objective, a look a search, tags.

/// Index of no condition: a series over all of them.
inline constexpr std::size_t kAllConditions = static_cast<std::size_t>(-1);

/// Empty series of a method with its label, look and tags, for one condition or for all. That of
/// one condition is hidden until a filter asks for it.
report::Series method_series(const BenchmarkGrid& grid, std::size_t method, std::size_t condition,
                             report::SeriesStyle style);
report::Tags method_tags(const BenchmarkGrid& grid, std::size_t method);
/// Values of the tag "condition" of what belongs to one condition and is shown among all, too.
report::Tag condition_tag(const BenchmarkGrid& grid, std::size_t condition);

/// One panel an objective, with the series that `add` puts into it for each of its methods; panels
/// without any are left out.
std::vector<report::Panel> objective_panels(
    const BenchmarkGrid& grid, const report::Axis& x, const report::Axis& y,
    const std::function<void(std::size_t method, report::Panel& panel)>& add);

/// The figure with the panels side by side.
report::Figure panel_figure(report::Figure figure, std::vector<report::Panel> panels);

/// All conditions together, then, where there are several, each.
std::vector<std::size_t> condition_choices(const BenchmarkGrid& grid);

/// `count` indices of [0, size), evenly spread, first and last among them; all where they fit.
std::vector<std::size_t> spread_indices(std::size_t size, std::size_t count);

/// Kind "benchmark": objectives and optimizers on the same truths, noise and starts.
class BenchmarkExperiment final : public AxisExperiment<CalibrateOptions, SuccessOptions> {
 public:
  using AxisExperiment::AxisExperiment;
  std::string_view for_structures() const override {
    return "benchmark compares optimizers on a string; the modes of any other structure have one "
           "search of their own: sweep its settings (sweep: {product: ...} in the file of kind: "
           "calibrate or identify_force)";
  }
  std::vector<Finding> lint() const override;
  std::vector<PlanLine> plan() const override;

  std::string run_task(std::size_t task, const StudyContext& context) const override;
  std::string loss_name() const override { return "median relative frequency error"; }
  std::optional<double> loss_in(const std::string& outcome) const override;
  StudyResult sum_up(const TaskOutcomes& outcomes, const StudyContext& context) const override;

 private:
  bool is_excused(const CalibrateOptions& cell, const Finding& finding) const override;
  void visit_scoring(OptionVisitor& visitor) const override;
  void draw_all(CalibrateOptions& cell) const override;
  BenchmarkLabels labels_of(std::size_t task) const;
  BenchmarkGrid grid(const TaskOutcomes& outcomes, StudyResult& result) const;
  std::shared_ptr<FrequencyBounds> bounds_ = std::make_shared<FrequencyBounds>();
};

}  // namespace modcal
