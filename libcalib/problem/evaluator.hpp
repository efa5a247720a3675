// The one door between optimizers and objectives.
#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "libcalib/problem/budget.hpp"
#include "libcalib/problem/objective_function.hpp"
#include "libcalib/problem/optimization_result.hpp"
#include "libcalib/problem/variable.hpp"

namespace modcal {

/// Counts, times, scales, bounds and traces evaluations, keeps the best point and enforces the
/// budget, so that no optimizer does. Optimizers see z = (x − initial)/scale in a box; what leaves
/// the box is put back onto it. One evaluator serves one search in one thread.
class Evaluator {
 public:
  /// Thrown where the search must end; caught by Optimizer::minimize.
  struct Stopped {};
  /// What came of an evaluation: kOver ends the search.
  enum class Trial { kFinite, kRejected, kOver };

  /// Throws InvalidInput for an invalid budget and for variables whose bounds do not hold the
  /// initial value or leave no room, or whose scale is not positive. function must outlive the
  /// evaluator.
  Evaluator(const ObjectiveFunction& function, std::span<const Variable> variables,
            const Budget& budget, SecondsClock clock = steady_seconds());
  /// Search of a stage within that of `parent`, which lends it budget and clock and outlives it.
  /// places: where the variables stand among the parent's, if the function is the parent's with all
  /// others held at `held` (user units): its values count as the parent's; else empty.
  Evaluator(Evaluator& parent, const ObjectiveFunction& function,
            std::span<const Variable> variables, std::vector<std::size_t> places = {},
            std::vector<double> held = {});

  std::size_t dimension() const { return variables_.size(); }
  const ObjectiveFunction& function() const { return function_; }
  std::size_t residual_count() const { return function_.residual_count(); }
  std::span<const Variable> variables() const { return variables_; }
  std::span<const double> lower() const { return lower_; }  ///< scaled
  std::span<const double> upper() const { return upper_; }  ///< scaled
  std::vector<double> start() const { return std::vector<double>(dimension(), 0.0); }
  /// Evaluations the budget still allows.
  std::int64_t evaluations_left() const;

  /// Evaluates at the initial point, which counts like any other and is the first to beat. Throws
  /// like evaluate(), and Stopped where the value is not a number.
  void begin();
  /// Evaluates at z; outputs in scaled variables. Throws Stopped where the search is over, and what
  /// the objective throws. Where the value, a residual or a slope is not finite the step is to be
  /// rejected: the result is false and the value +∞.
  ///
  /// A gradient the objective does not give is Jᵀr where it has a Jacobian; else it and a Jacobian
  /// are differences over h = ε^⅓ max(1, |z_i|), ε the machine's: central ones, wrong by h² times
  /// a third derivative, or (−3 f(z) + 4 f(z ± h) − f(z ± 2h))/(±2h) where a bound is nearer than
  /// h or the objective is not finite on one side. They cost two evaluations a variable, and two
  /// more where a side is not finite, which count like any other.
  bool evaluate(std::span<const double> z, const ObjectiveOutputs& outputs);
  double value(std::span<const double> z);
  /// The same for callbacks of libraries, which exceptions must not cross and infinite values
  /// upset. An exception is kept and thrown by finish(). A rejected step gets a finite value above
  /// all that were met, residuals of that half square, and slopes of 0; before a finite value, or
  /// finite slopes where these are asked for, there is nothing to go back to: the search is over.
  Trial try_evaluate(std::span<const double> z, const ObjectiveOutputs& outputs) noexcept;
  bool stopped() const {
    return stop_ != StopReason::kNotRun || error_ != nullptr || (parent_ && parent_->stopped());
  }

  /// Stepping along single variables, in user units, from the initial point and after begin(). The
  /// point it stands at is the search's answer, because values of parts cannot be compared over
  /// variables. One evaluation of the budget is kept for the value of the answer.
  void open_scan();
  /// Current point of the scan.
  std::span<const double> position() const { return position_; }
  /// Every candidate counts as one evaluation. Throws Stopped, with nothing evaluated, where the
  /// budget does not allow all of them.
  void scan(std::size_t i, std::span<const double> candidates, std::span<double> values);
  void move(std::size_t i, double x);
  void refresh_scan() { scanner_->refresh(); }
  void record(CoordinateScan scan) { result_.scans.push_back(std::move(scan)); }
  std::vector<CoordinateScan>& recorded_scans() { return result_.scans; }
  bool reaches(std::size_t j, std::size_t i) const { return scanner_->reaches(j, i); }
  void count_loop(std::size_t searched) {
    ++result_.loops;
    result_.searched.push_back(static_cast<std::int64_t>(searched));
  }

  /// Reads the clock between evaluations. Throws Stopped where the search is over.
  void poll() { require_budget(0); }
  /// Allows and counts evaluations that the evaluator does not make itself. Throws Stopped where
  /// the search is over.
  void spend(std::int64_t evaluations) {
    require_budget(evaluations);
    count(evaluations);
  }
  std::int64_t evaluations() const { return result_.evaluations; }
  void end_stage(FitStage stage) { result_.stages.push_back(std::move(stage)); }
  const std::vector<FitStage>& stages() const { return result_.stages; }
  /// The answer of a search whose stages have objectives that do not compare, in user units.
  void answer(std::vector<double> x, double value);
  void report(std::shared_ptr<const ContinuationResult> estimate) {
    result_.estimate = std::move(estimate);
  }

  /// Ends the search: throws what the objective threw, else gives the result. A reason the
  /// evaluator had to stop for goes before the back end's.
  OptimizationResult finish(StopReason reason);

 private:
  /// What the difference rule applies to: the value (one number) or the residuals.
  using Sample = std::function<bool(std::span<const double> z, double* numbers)>;

  [[noreturn]] void stop(StopReason reason);
  void count(std::int64_t evaluations);
  void require_budget(std::int64_t evaluations);
  double seconds() const { return clock_() - begin_; }
  void to_user(std::span<const double> z);
  void to_scaled(const ObjectiveOutputs& outputs) const;
  void note(double value);
  bool finite(const ObjectiveOutputs& outputs) const;
  void fill_rejected(const ObjectiveOutputs& outputs) const;
  /// Evaluates what the objective itself gives.
  bool evaluate_given(std::span<const double> z, const ObjectiveOutputs& outputs);
  bool evaluate_with_differences(std::span<const double> z, const ObjectiveOutputs& outputs);
  bool gradient_from_residuals(std::span<const double> z, const ObjectiveOutputs& outputs);
  /// Slopes of the numbers, row-major count × n, from their values at z.
  void difference(std::span<const double> z, const Sample& sample, std::span<const double> numbers,
                  double* slopes);

  Evaluator* parent_ = nullptr;
  std::vector<std::size_t> places_;
  std::vector<double> held_;
  const ObjectiveFunction& function_;
  std::vector<Variable> variables_;
  Budget budget_;
  SecondsClock clock_;
  double begin_;
  std::vector<double> lower_;
  std::vector<double> upper_;
  std::vector<double> x_;  // point of the current evaluation
  double best_value_;
  double worst_value_;
  bool slopes_known_ = false;
  std::vector<double> best_;
  StopReason stop_ = StopReason::kNotRun;
  std::exception_ptr error_;
  std::unique_ptr<CoordinateScanner> scanner_;
  std::vector<double> position_;
  bool moved_ = false;
  OptimizationResult result_;
};

/// df/dx_i at x in the units of the variables: the function's own, or by the differences above
/// where it gives none.
std::vector<double> gradient_at(const ObjectiveFunction& function,
                                std::span<const Variable> variables, std::span<const double> x);

}  // namespace modcal
