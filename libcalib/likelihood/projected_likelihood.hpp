// Joint likelihood of both reactions with the force eliminated and the end state projected out.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "libcalib/likelihood/likelihood_outputs.hpp"
#include "libcalib/parameters/parameters.hpp"

namespace modcal {

/// The modes as the kernels see them. Throws InvalidInput for an undamped mode or one above the
/// Nyquist frequency.
std::vector<LikelihoodMode> likelihood_modes(const ModelPoint& point, double sample_rate);

/// With h_r = H_r/s_r, κ_n = (h_2/s_1 + (−1)ⁿ h_1/s_2)/|h| and the sampled free decay of what the
/// record leaves ringing, u_n = c_n U_n + conj(c_n) U'_n (c_n a linear unknown):
///
///     e = (h_2 y_1 − h_1 y_2)/|h| + Σ_n κ_n u_n        CN(0, 1) at the truth,
///     J_i = Σ_n κ_n (F̂ ∂P_n/∂θ_i + ∂u_n/∂θ_i),        F̂ = Σ_r conj(h_r) Y_r/|h|²,
///
/// Y_r the data without their transients. Where noise has a spectrum, C in a bin, |h|² is
/// hᴴ adj(C) h = C₂₂|h_1|² + C₁₁|h_2|² − 2 C₁₂ Re conj(h_1) h_2, and F̂ = hᴴ adj(C) Y/|h|²: y and h
/// whitened by C^(−1/2) have the same determinant h_2y_1 − h_1y_2 but for its own. J is ∂e/∂θ
/// without the turn i e Im(hᴴ∂h)/|h|² of the residual's phase, which changes neither cost nor
/// gradient. The 2N real unknowns c_n are projected out of both (end_state.hpp); for σ > 0 the
/// static offsets of both records are, in their place. J is linear in the data at fixed θ.
class ProjectedLikelihood {
 public:
  using Outputs = LikelihoodOutputs;

  /// At σ = 0 the end state is projected out; for σ > 0 the system is taken to be at rest at t = 0,
  /// and σ hides the end.
  explicit ProjectedLikelihood(WhitenedRecord record);

  const WhitenedRecord& record() const { return record_; }
  void set_weights(std::span<const double> weights);  ///< w_k of the K_b bins, in [0, 1]
  /// Residuals less unknowns that were projected out: end state or offsets, what the sensors hold.
  double degrees_of_freedom(std::size_t parameters, const ModelPoint& point) const;

  double cost(const ModelPoint& point) const;
  /// Cost and slope alone, at a tenth of the price where there are many columns.
  LikelihoodPoint slope(const ModelPoint& point, const LikelihoodColumns& columns) const;
  LikelihoodPoint evaluate(const ModelPoint& point, const LikelihoodColumns& columns,
                           const Outputs& outputs) const;
  /// Cost, slope and the rows of the information that belong to the unknowns `wanted`, in their
  /// order: the columns of these alone, and their products by modes, where they are few; else all
  /// rows. One to four of 52 rows take 0.3 to 0.6 of the time of all.
  LikelihoodPoint rows(const ModelPoint& point, const LikelihoodColumns& columns,
                       std::span<const std::size_t> wanted) const;
  LikelihoodPoint evaluate(const ModelPoint& point, const LikelihoodColumns& columns) const {
    return evaluate(point, columns, Outputs{});
  }
  /// N̄ = E Re J⊥ᴴ W J⊥ over data of pure noise, by `repeats` simulated records: what noise adds to
  /// the information, E JᵀJ = A + N̄.
  Eigen::MatrixXd noise_information(const ModelPoint& point, const LikelihoodColumns& columns,
                                    std::size_t repeats) const;

 private:
  WhitenedRecord record_;
};

}  // namespace modcal
