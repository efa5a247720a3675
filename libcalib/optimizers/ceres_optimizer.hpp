#pragma once

#include <string>

#include "libcalib/optimizer.hpp"

namespace modcal {

/// Trust-region least squares of Ceres Solver (Agarwal, Mierle and others): Levenberg–Marquardt,
/// Powell's dogleg or the dogleg in the subspace of its two legs, on the residuals, within the
/// bounds. Prints nothing.
class CeresOptimizer final : public Optimizer {
 public:
  struct Options {
    std::string strategy = "levenberg_marquardt";
    double gradient_tolerance = 1e-12;  ///< of the scaled gradient's largest entry
    double step_tolerance = 1e-10;      ///< relative to the scaled variables [1]
    double value_tolerance = 1e-14;     ///< relative to the value [1]
    double initial_radius = 1e4;        ///< of the trust region, scaled variables [1]
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput for an unknown strategy.
  explicit CeresOptimizer(const Options& options);
  std::string_view name() const override { return "ceres"; }
  Capabilities needs() const override { return {.least_squares = true}; }

 private:
  StopReason search(Evaluator& evaluator) const override;

  Options options_;
};

/// Line search of Ceres Solver along quasi-Newton or conjugate directions (Nocedal and Wright,
/// 2006): bfgs, lbfgs, fletcher_reeves, polak_ribiere, hestenes_stiefel, steepest_descent. It knows
/// no bounds: it searches through UnboundedSearch. Prints nothing.
class CeresLineSearch final : public Optimizer {
 public:
  struct Options {
    std::string direction = "bfgs";
    double gradient_tolerance = 1e-12;  ///< of the scaled gradient's largest entry
    double step_tolerance = 1e-10;      ///< relative to the scaled variables [1]
    double value_tolerance = 1e-14;     ///< relative to the value [1]
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput for an unknown direction.
  explicit CeresLineSearch(const Options& options);
  std::string_view name() const override { return "ceres_line_search"; }
  Capabilities needs() const override { return {.gradient = true}; }

 private:
  StopReason search(Evaluator& evaluator) const override;

  Options options_;
};

}  // namespace modcal
