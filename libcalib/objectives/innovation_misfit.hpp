#pragma once

#include <cstdint>

#include "libcalib/objective.hpp"

namespace modcal {

/// Innovation misfit of the model-based estimate, the simulator in the loop: an observer with the
/// exponential friction law predicts both reactions, r_j = ±√(2ρ(ν_j/s)) with the scaled
/// innovations ν/s of all samples (ρ Huber's, corner 3), value ½ ‖r‖²; value over the number of
/// samples is the misfit J under one gain: 1.1 to 1.3 where model and noise are right, twice that
/// for x_c off by 0.1 mm at 2 % noise. At bind the friction is fitted with
/// the initial model (ModelBasedEstimator); each evaluation fits it again with its own model, a few
/// steps from there: friction, bow, adherence and offsets are eliminated. The reaction at x = L is
/// taken back through its sensor, R₂ = R₂'/S (Sensor), before it is predicted; with a delay the
/// last samples, which it reaches beyond the record, are left out. No slopes of its own.
/// One evaluation takes iterations × 15 simulations of the record.
class InnovationMisfit final : public Objective {
 public:
  struct Options {
    std::int64_t substeps = 5;    ///< steps of the observer per sample
    std::int64_t iterations = 3;  ///< of the friction's fit in an evaluation; 0: as at bind
    /// q of the observer's gain, relative to the static friction force at bind: the smaller, the
    /// more the observer trusts its model [1].
    double force_noise = 0.0075;
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput for fewer than one substep, negative iterations, a force noise not > 0.
  explicit InnovationMisfit(const Options& options);
  /// All of them: the observer has the damping of the model and reads R₂ as its sensor's gain,
  /// delay and corner say.
  Response response(Moves what) const override;
  Capabilities capabilities() const override { return {.residuals = true}; }

 private:
  /// Throws InvalidInput where a reaction is missing and where the record shows no stick and slip
  /// or does not start at rest.
  std::unique_ptr<const ObjectiveFunction> do_bind(const CalibrationData& data,
                                                   const ParameterSet& parameters) const override;

  Options options_;
};

}  // namespace modcal
