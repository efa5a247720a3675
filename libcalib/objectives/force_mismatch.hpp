#pragma once

#include <string>

#include "libcalib/objective.hpp"
#include "libcalib/objectives/two_sided_force.hpp"

namespace modcal {

/// Two-sided force mismatch: both reactions carry one force, so
/// r = w_k (F_1 − F_2)(ω_k)/√(½ Σ w_k² (|F_1|² + |F_2|²)), real and imaginary part of every bin in
/// turn, value ½ ‖r‖² [1]; the denominator and the weights are those of the initial parameters.
/// Weights: uniform, or transfer: w_k = (|H_1|^−2 + |H_2|^−2)^−½, under which equal noise in both
/// reactions gives equal noise in all residuals.
class ForceMismatch final : public Objective {
 public:
  struct Options {
    TwoSidedForceOptions inversion;
    std::string weights = "uniform";
    void visit(OptionVisitor& visitor);
  };
  explicit ForceMismatch(const Options& options);

 private:
  /// Throws InvalidInput where a reaction is missing or holds nothing in the band.
  std::unique_ptr<const ObjectiveFunction> do_bind(const CalibrationData& data,
                                                   const ParameterSet& parameters) const override;

  Options options_;
};

}  // namespace modcal
