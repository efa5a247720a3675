#pragma once

#include <limits>

#include "libcalib/objective.hpp"

namespace modcal {

/// Joint likelihood of both reactions, the force eliminated in every bin: r = √2 (Re e, Im e) with
/// the whitened residual e of ProjectedLikelihood, value ½ ‖r‖²; ‖r‖²/(2K_b − 2N − n) is the
/// reduced χ², 1 for a right model (two less where a sensor's gain, delay or corner is free: what
/// the sensor holds when the record ends is projected out). The Jacobian is that of e without the
/// turn of its phase and with the end state projected out; its gradient Jᵀr is exact.
class JointLikelihood final : public Objective {
 public:
  struct Options {
    /// σ [1/s] by which the records are damped before they are compared: wide basins; 0: the whole
    /// record, its end state projected out.
    double damping = 0.0;
    double highest_frequency = std::numeric_limits<double>::quiet_NaN();  ///< [Hz]
    double left_noise = std::numeric_limits<double>::quiet_NaN();         ///< s_1 [N]
    double right_noise = std::numeric_limits<double>::quiet_NaN();        ///< s_2 [N]
    void visit(OptionVisitor& visitor);
  };
  explicit JointLikelihood(const Options& options);
  Response response(Moves /*what*/) const override { return Response::kMoves; }
  /// Damped records have correlated bins.
  bool whitened() const override { return options_.damping == 0.0; }
  Capabilities capabilities() const override {
    return {.gradient = true,
            .least_squares = true,
            .information = true,
            .damped = true,
            .schedule = options_.damping == 0.0};
  }
  double highest_frequency() const override { return options_.highest_frequency; }
  /// Refuses a record in which a noise level that is not stated cannot be seen.
  void require_record(const ModalBasis& basis, double sample_rate,
                      std::size_t samples) const override;

 private:
  /// Throws InvalidInput where a reaction is missing.
  std::unique_ptr<const ObjectiveFunction> bind_problem(
      const Problem& problem, const ParameterSet& parameters) const override;
  std::unique_ptr<const ObjectiveFunction> do_bind(const CalibrationData& data,
                                                   const ParameterSet& parameters) const override;

  Options options_;
};

}  // namespace modcal
