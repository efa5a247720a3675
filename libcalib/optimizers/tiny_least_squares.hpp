#pragma once

#include "libcalib/optimizer.hpp"

namespace modcal {

/// Levenberg–Marquardt on the normal equations with Nielsen's damping (Madsen, Nielsen and
/// Tingleff, 2004, algorithm 3.16), for few parameters and many short fits: allocates before its
/// first step and never after it. (JᵀJ + μ diag JᵀJ) δ = −Jᵀr loses half the digits of the
/// condition of J: "ceres" and "gsl" work on J itself. Searches through UnboundedSearch.
class TinyLeastSquares final : public Optimizer {
 public:
  struct Options {
    double gradient_tolerance = 1e-12;  ///< of the scaled gradient's largest entry
    double step_tolerance = 1e-10;      ///< relative to the scaled variables [1]
    double value_tolerance = 1e-14;     ///< relative to the value [1]
    double initial_damping = 1e-4;      ///< μ, relative to diag JᵀJ [1]
    void visit(OptionVisitor& visitor);
  };
  explicit TinyLeastSquares(const Options& options);
  std::string_view name() const override { return "tiny_least_squares"; }
  Capabilities needs() const override { return {.least_squares = true}; }

 private:
  StopReason search(Evaluator& evaluator) const override;

  Options options_;
};

}  // namespace modcal
