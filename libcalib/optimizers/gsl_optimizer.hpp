#pragma once

#include <span>
#include <string>
#include <string_view>

#include "libcalib/optimizer.hpp"

namespace modcal {

/// An algorithm of the GNU Scientific Library (Galassi and others):
/// simplex (Nelder and Mead, 1965), no slopes: nmsimplex, nmsimplex2, nmsimplex2rand;
/// descent along the gradient: conjugate_fr, conjugate_pr, vector_bfgs, vector_bfgs2,
/// steepest_descent;
/// least squares on the residuals (trust region): lm, lmaccel, dogleg, ddogleg, subspace2d;
/// one variable, no slopes: brent, golden_section, quad_golden.
/// None knows bounds: they search through UnboundedSearch. The library's error handler, which ends
/// the process, is switched off for the whole process at the first use.
class GslOptimizer final : public Optimizer {
 public:
  struct Options {
    std::string algorithm = "vector_bfgs2";
    double gradient_tolerance = 1e-10;  ///< norm of the scaled gradient
    double step_tolerance = 1e-9;       ///< step, size of a simplex or of a bracket, scaled [1]
    double value_tolerance = 1e-14;     ///< relative to the value [1]
    double initial_step = 0.1;          ///< on the scaled variables [1]
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput for an unknown algorithm.
  explicit GslOptimizer(const Options& options);
  std::string_view name() const override { return "gsl"; }
  Capabilities needs() const override;

  static std::span<const std::string_view> algorithms();

 private:
  /// The searches in one variable refuse more; least squares refuse fewer residuals than variables.
  void require_feasible(const Evaluator& evaluator) const override;
  StopReason search(Evaluator& evaluator) const override;

  Options options_;
};

}  // namespace modcal
