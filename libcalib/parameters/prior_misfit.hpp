// How far a fit ends from what was stated of it beforehand.
#pragma once

#include <cstddef>
#include <string>

namespace modcal {

/// Misfit of k stated coordinates with residual d and covariance C. Where the statements are true,
/// d at the fit scatters by no more than C, so that chi2 is at most a χ² of k degrees of freedom.
struct PriorMisfit {
  double chi2 = 0.0;        ///< dᵀC⁻¹d
  std::size_t count = 0;    ///< k
  std::string farthest;     ///< parameter of largest |d_i|/√C_ii
  double deviations = 0.0;  ///< that quotient
  /// chi2 is above the quantile 0.9973 of χ²_k, three standard deviations of one coordinate.
  bool contradicted() const;
};

}  // namespace modcal
