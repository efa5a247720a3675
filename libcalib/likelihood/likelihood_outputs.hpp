// What an evaluation of the joint likelihood is asked for and what it gives.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "libcalib/likelihood/kernels/likelihood_kernel.hpp"

namespace modcal {

/// One evaluation at a model.
struct LikelihoodPoint {
  double cost = 0.0;               ///< Σ_k w_k |e_k|², and what holds the end state (EndState)
  Eigen::VectorXd slope;           ///< Re Jᴴ W e: half the gradient of the cost
  Eigen::MatrixXd information;     ///< Re J⊥ᴴ W J⊥
  Eigen::MatrixXd twice_weighted;  ///< Re J⊥ᴴ W² J⊥, where asked for
};

/// Null: not asked for.
struct LikelihoodOutputs {
  bool twice_weighted = false;
  /// √w e, real and imaginary part in turn, then √R of the end state: 2K_b + 1.
  std::vector<double>* residuals = nullptr;
  Eigen::MatrixXd* jacobian = nullptr;    ///< √w J⊥ and ∂√R, rows in the same order
  std::vector<Complex>* force = nullptr;  ///< F̂, whitened like y_r, K_b numbers
  std::vector<double>* gain = nullptr;    ///< hᴴC⁻¹h, K_b numbers
  std::vector<Complex>* amplitudes = nullptr;
  std::vector<Complex>* left = nullptr;   ///< h_1, K_b numbers
  std::vector<Complex>* right = nullptr;  ///< h_2
};

}  // namespace modcal
