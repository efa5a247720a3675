// Lobatto nodes on [0, 1] and what collocation at them needs.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace modcal::event {

/// Most nodes of a rule. Fixed by: the largest rule that kernels are compiled for.
inline constexpr int kMaxNodes = 5;

/// s = 2…5 Lobatto nodes 0 = c_1 < … < c_s = 1 with their Lagrange polynomials.
struct LobattoRule {
  using Row = std::array<double, kMaxNodes>;

  int nodes = 0;
  Row node{};                          ///< c_i
  std::array<Row, kMaxNodes> power{};  ///< ℓ_j(θ) = Σ_k power[j][k] θ^k
  /// Bernstein coefficients of the polynomial through node values: β_i = Σ_j bernstein[i][j] x_j.
  std::array<Row, kMaxNodes> bernstein{};
  /// max |Π (θ − c_i)|/s!: |x − interpolant| ≤ remainder · max |x^(s)| (Cauchy).
  double remainder = 0.0;

  /// Power coefficients in θ of the polynomial through the node values.
  Row powers_of(const Row& value) const {
    Row powers{};
    for (int j = 0; j < nodes; ++j) {
      for (int k = 0; k < nodes; ++k) powers[k] += value[j] * power[j][k];
    }
    return powers;
  }
  /// Lowest control point of its Bézier polygon: no value in between is below.
  double lowest_control(const Row& value) const {
    double lowest = HUGE_VAL;
    for (int i = 0; i < nodes; ++i) {
      double control = 0.0;
      for (int j = 0; j < nodes; ++j) control += bernstein[i][j] * value[j];
      lowest = std::min(lowest, control);
    }
    return lowest;
  }
  /// Bound of |θ^m − its interpolant| on [0, 1]: remainder · m!/(m − s)!.
  double power_remainder(int m) const;
};

/// Throws InvalidInput unless 2 ≤ nodes ≤ 5.
LobattoRule lobatto_rule(int nodes);

}  // namespace modcal::event
