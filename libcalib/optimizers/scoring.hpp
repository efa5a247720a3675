#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <vector>

#include "libcalib/optimizer.hpp"

namespace modcal {

/// Where a search by scoring ended, in scaled variables.
struct ScoringFit {
  Eigen::VectorXd z;
  double value = std::numeric_limits<double>::infinity();
  Eigen::VectorXd gradient;
  Eigen::MatrixXd information, noise, prior;  ///< rows of the information may be those before
  bool converged = false;
};

/// What a search by scoring may save.
struct ScoringShortcuts {
  bool slopes = true;       ///< the gradient alone costs less than with the information
  bool rows = true;         ///< so do some rows of the information
  Eigen::VectorXd largest;  ///< change of every variable in one step; empty: no limit
  const ScoringFit* at_start = nullptr;  ///< what is known there; null: it is evaluated
};

/// Minus the logarithm of a likelihood by Newton steps of the debiased information, damped where a
/// step does not serve (Levenberg–Marquardt), projected onto the bounds: a variable that the
/// gradient presses against one takes no part. The information is found where a step starts: not
/// where one is refused, nor where the last one ends. Variables that have moved by less than a
/// fifth of their standard deviation since their row of it was found keep that row, save what they
/// share with one that has moved.
class Scoring final : public Optimizer {
 public:
  struct Options {
    std::int64_t steps = 50;
    /// Ends when gᵀH⁻¹g is below this: the step is then below its root in standard deviations.
    double tolerance = 1e-4;
    void visit(OptionVisitor& visitor);
  };
  explicit Scoring(const Options& options) : options_(options) {}
  std::string_view name() const override { return "scoring"; }
  Capabilities needs() const override { return {.information = true}; }

  /// The search from the initial point.
  static ScoringFit fit(Evaluator& evaluator, const Options& options,
                        const ScoringShortcuts& shortcuts = {});

 private:
  bool starts_from_value() const override { return false; }
  StopReason search(Evaluator& evaluator) const override;

  Options options_;
};

}  // namespace modcal
