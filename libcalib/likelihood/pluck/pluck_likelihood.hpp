// Likelihood of a plucked string's reactions: free decays and noise, no force.
#pragma once

#include "libcalib/likelihood/record_likelihood.hpp"
#include "libcalib/likelihood/records/whitened_record.hpp"

namespace modcal {

/// With U_n = 1/(1 − E_n z^−1) of the sampled free decay and U'_n that of conj(E_n),
///
///     e_1 = y_1 − Σ_n u_n/s_1,   e_2 = y_2 + Σ_n (−1)ⁿ u_n/s_2,   u_n = c_n U_n + conj(c_n) U'_n,
///
/// both CN(0, 1) at the truth; at x = L c_n has the factor g e^(−λτ) λ/(λ + ω_h) of the sensor
/// there, λ_n = f_s ln E_n, and where it differs a sample and a decay of its own stand beside them.
/// The 2N real unknowns c_n are common to both ends and projected out by the normal equations,
/// ridge 1e-9. The record begins when the string has been left to itself. x_c is unknown to it.
class PluckLikelihood final : public RecordLikelihood {
 public:
  /// A record at σ = 0. Throws InvalidInput for another.
  explicit PluckLikelihood(WhitenedRecord record);

  const WhitenedRecord& record() const { return record_; }
  LikelihoodPoint evaluate(const ModelPoint& point, const LikelihoodColumns& columns,
                           const LikelihoodOutputs& outputs = {}) const override;
  /// Real and imaginary part of e_1 and e_2 of a bin in turn.
  std::size_t residual_count() const override { return 4 * record_.bins; }
  /// By three simulated records.
  Eigen::MatrixXd noise_information(const ModelPoint& point,
                                    const LikelihoodColumns& columns) const override;
  LikelihoodPoint unweighted(const ModelPoint& point,
                             const LikelihoodColumns& columns) const override;
  double cost(const ModelPoint& point) const;
  double degrees_of_freedom(const ModelPoint& point) const override;
  /// Power that a decay with this pole explains in the bins about it: where it peaks over ω_n is
  /// where the mode rings.
  double power_about(std::complex<double> pole, double omega) const;

 private:
  WhitenedRecord record_;
};

}  // namespace modcal
