// A function to be minimized, as optimizers see it.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "libcalib/problem/variable.hpp"

namespace modcal {

/// What an objective can compute besides its value, or what an optimizer needs of it.
struct Capabilities {
  bool gradient = false;
  /// Residuals r with value = ½ ‖r‖², and their Jacobian.
  bool least_squares = false;
  /// The residuals without their Jacobian.
  bool residuals = false;
  /// The Fisher information of a likelihood, of which the value is minus the logarithm.
  bool information = false;
  /// The same on the record damped by exp(−σt).
  bool damped = false;
  /// A schedule of stages of its own, which `staged` follows where no stages are stated.
  bool schedule = false;

  bool sum_of_squares() const { return least_squares || residuals; }
};

/// Where an evaluation writes. A null pointer means "not asked for".
struct ObjectiveOutputs {
  double* value = nullptr;
  double* gradient = nullptr;   ///< n numbers ∂value/∂x_i
  double* residuals = nullptr;  ///< m numbers
  double* jacobian = nullptr;   ///< m × n, row-major, ∂r_j/∂x_i
  /// n × n, what the data tell: JᵀWJ of the whitened residuals, the value's Hessian but for noise
  /// and prior.
  Eigen::MatrixXd* information = nullptr;
  /// Variables whose rows of the information are wanted, which then come alone, or all of them
  /// where that costs no more; null: all.
  const std::vector<std::size_t>* rows = nullptr;
  Eigen::MatrixXd* noise = nullptr;  ///< n × n, N̄: what noise adds to JᵀWJ, 0 where not known
  Eigen::MatrixXd* prior = nullptr;  ///< n × n, Hessian of what the value holds of prior knowledge
};

class Evaluator;
enum class StopReason;

/// How a schedule of stages is followed.
struct ScheduleOptions {
  std::int64_t restarts = 4;  ///< other starts tried while χ² says that the fit is wrong
};

/// The part of an objective that belongs to one variable, for many values of that variable at once.
/// Holds a current point; one object per thread.
class CoordinateScanner {
 public:
  virtual ~CoordinateScanner() = default;
  /// values_j = the part of the objective that variable i answers for, with x_i = candidates_j and
  /// all others at the current point.
  virtual void scan(std::size_t i, std::span<const double> candidates,
                    std::span<double> values) = 0;
  /// Moves variable i of the current point.
  virtual void move(std::size_t i, double value) = 0;
  /// Whether a step of variable j may move the candidate of variable i whose part is least; true
  /// where that is not known. Both at the current point.
  virtual bool reaches(std::size_t /*j*/, std::size_t /*i*/) const { return true; }
  /// Computes afresh what scan() and move() keep up to date, so that rounding does not gather.
  virtual void refresh() {}
};

/// Objective bound to data and variables: const and safe to use from several threads at once.
class ObjectiveFunction {
 public:
  virtual ~ObjectiveFunction() = default;
  virtual std::string_view name() const = 0;
  /// Number of variables n.
  virtual std::size_t dimension() const = 0;
  /// Number of residuals m; 0 for an objective that is no sum of squares.
  virtual std::size_t residual_count() const { return 0; }
  virtual Capabilities capabilities() const = 0;

  /// Evaluates at x (n values in user units) what is asked for. Throws InvalidInput where an output
  /// is asked for that the capabilities exclude.
  void evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const;
  double value(std::span<const double> x) const;

  /// Scanner standing at x. By default every candidate is one evaluation, and the part of a
  /// variable is the whole objective.
  virtual std::unique_ptr<CoordinateScanner> scanner(std::span<const double> x) const;
  /// The same objective on the record damped by exp(−σt), σ > 0 [1/s]: wide basins. Throws
  /// InvalidInput where it has no such form.
  virtual std::unique_ptr<const ObjectiveFunction> damped(double sigma) const;
  /// Searches by the schedule of stages that the objective brings along and says why it ended.
  /// Throws InvalidInput where it has none.
  virtual StopReason follow_schedule(Evaluator& evaluator, const ScheduleOptions& options) const;

 private:
  virtual void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const = 0;
};

/// Scanner by a loop of evaluations, and base of faster ones.
class EvaluatingScanner : public CoordinateScanner {
 public:
  EvaluatingScanner(const ObjectiveFunction& function, std::span<const double> x)
      : function_(function), x_(x.begin(), x.end()) {}
  void scan(std::size_t i, std::span<const double> candidates, std::span<double> values) override;
  void move(std::size_t i, double value) override { x_[i] = value; }

 protected:
  std::span<const double> point() const { return x_; }

 private:
  const ObjectiveFunction& function_;
  std::vector<double> x_;
};

}  // namespace modcal
