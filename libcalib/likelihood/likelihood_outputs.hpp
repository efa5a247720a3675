// What an evaluation of the joint likelihood is asked for and what it gives.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "libcalib/likelihood/likelihood_kernel.hpp"

namespace modcal {

/// How the columns of a Jacobian are made of ∂/∂ln ω_n and ∂/∂ln ζ_n, and which ones are those of
/// x_c and of the sensor at x = L: ln of its gain, delay [s], corner [rad/s].
struct LikelihoodColumns {
  std::size_t count = 0;
  std::vector<ColumnShare> shares;       ///< by mode
  std::vector<std::size_t> share_begin;  ///< N + 1 numbers: where those of mode n begin
  std::optional<std::size_t> contact = {};
  std::optional<std::size_t> gain = {}, delay = {}, corner = {};
  /// Gain, delay and corner in this order.
  std::array<std::optional<std::size_t>, 3> sensors() const { return {gain, delay, corner}; }
};

/// One evaluation at a model.
struct LikelihoodPoint {
  double cost = 0.0;               ///< Σ_k w_k |e_k|²
  Eigen::VectorXd slope;           ///< Re Jᴴ W e: half the gradient of the cost
  Eigen::MatrixXd information;     ///< Re J⊥ᴴ W J⊥
  Eigen::MatrixXd twice_weighted;  ///< Re J⊥ᴴ W² J⊥, where asked for
};

/// Null: not asked for.
struct LikelihoodOutputs {
  bool twice_weighted = false;
  std::vector<double>* residuals = nullptr;  ///< √w e, real and imaginary part in turn: 2K_b
  Eigen::MatrixXd* jacobian = nullptr;       ///< √w J⊥, rows in the same order
  std::vector<Complex>* force = nullptr;     ///< F̂, whitened like y_r, K_b numbers
  std::vector<double>* gain = nullptr;       ///< |h|², K_b numbers
  std::vector<Complex>* amplitudes = nullptr;
  std::vector<Complex>* left = nullptr;   ///< h_1, K_b numbers
  std::vector<Complex>* right = nullptr;  ///< h_2
};

}  // namespace modcal
