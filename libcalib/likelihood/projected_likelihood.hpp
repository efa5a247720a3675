// Joint likelihood of both reactions with the force eliminated and the end state projected out.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "libcalib/likelihood/likelihood_kernel.hpp"
#include "libcalib/parameters.hpp"

namespace modcal {

/// How the columns of a Jacobian are made of ∂/∂ln ω_n and ∂/∂ln ζ_n, and which one is that of x_c.
struct LikelihoodColumns {
  std::size_t count = 0;
  std::vector<ColumnShare> shares;       ///< by mode
  std::vector<std::size_t> share_begin;  ///< N + 1 numbers: where those of mode n begin
  std::optional<std::size_t> contact;
};

/// The modes as the kernels see them. Throws InvalidInput for an undamped mode or one above the
/// Nyquist frequency.
std::vector<LikelihoodMode> likelihood_modes(const ModelPoint& point, double sample_rate);

/// One evaluation at a model.
struct LikelihoodPoint {
  double cost = 0.0;               ///< Σ_k w_k |e_k|²
  Eigen::VectorXd slope;           ///< Re Jᴴ W e: half the gradient of the cost
  Eigen::MatrixXd information;     ///< Re J⊥ᴴ W J⊥
  Eigen::MatrixXd twice_weighted;  ///< Re J⊥ᴴ W² J⊥, where asked for
};

/// With h_r = H_r/s_r, κ_n = (h_2/s_1 + (−1)ⁿ h_1/s_2)/|h| and the sampled free decay of what the
/// record leaves ringing, u_n = c_n U_n + conj(c_n) U'_n (c_n a linear unknown):
///
///     e = (h_2 y_1 − h_1 y_2)/|h| + Σ_n κ_n u_n        CN(0, 1) at the truth,
///     J_i = Σ_n κ_n (F̂ ∂P_n/∂θ_i + ∂u_n/∂θ_i),        F̂ = Σ_r conj(h_r) Y_r/|h|²,
///
/// Y_r the data without their transients. J is ∂e/∂θ without the turn i e Im(hᴴ∂h)/|h|² of the
/// residual's phase, which changes neither cost nor gradient. The 2N real unknowns c_n are
/// projected out of both (ridge 1e-9 of the normalized normal equations); for σ > 0 the static
/// offsets of both records are, too. J is linear in the data at fixed θ.
class ProjectedLikelihood {
 public:
  /// end_state: project c_n out; else the system is at rest at t = 0 and σ > 0 hides the end.
  ProjectedLikelihood(WhitenedRecord record, bool end_state);

  struct Outputs {
    bool twice_weighted = false;
    std::vector<double>* residuals = nullptr;  ///< √w e, real and imaginary part in turn: 2K_b
    Eigen::MatrixXd* jacobian = nullptr;       ///< √w J⊥, rows in the same order
    std::vector<Complex>* force = nullptr;     ///< F̂, whitened like y_r, K_b numbers
    std::vector<double>* gain = nullptr;       ///< |h|², K_b numbers
    std::vector<Complex>* amplitudes = nullptr;
  };

  const WhitenedRecord& record() const { return record_; }
  void set_weights(std::span<const double> weights);  ///< w_k of the K_b bins, in [0, 1]
  /// Residuals less unknowns that were projected out.
  double degrees_of_freedom(std::size_t parameters, std::size_t modes) const;

  double cost(const ModelPoint& point) const;
  LikelihoodPoint evaluate(const ModelPoint& point, const LikelihoodColumns& columns,
                           const Outputs& outputs) const;
  LikelihoodPoint evaluate(const ModelPoint& point, const LikelihoodColumns& columns) const {
    return evaluate(point, columns, Outputs{});
  }
  /// N̄ = E Re J⊥ᴴ W J⊥ over data of pure noise, by `repeats` simulated records: what noise adds to
  /// the information, E JᵀJ = A + N̄.
  Eigen::MatrixXd noise_information(const ModelPoint& point, const LikelihoodColumns& columns,
                                    std::size_t repeats) const;

 private:
  struct Workspace;
  std::size_t state_columns(std::size_t modes) const;
  void project(const WhitenedRecord& record, Workspace& work, bool keep_state) const;
  LikelihoodPoint differentiate(const WhitenedRecord& record, const LikelihoodColumns& columns,
                                Workspace& work, const Outputs& outputs) const;

  WhitenedRecord record_;
  bool end_state_;
};

}  // namespace modcal
