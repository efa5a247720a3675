// Lobatto nodes on [0, 1] and what collocation at them needs.
#pragma once

#include <array>

namespace modcal::event {

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

  /// Bound of |θ^m − its interpolant| on [0, 1]: remainder · m!/(m − s)!.
  double power_remainder(int m) const;
};

/// Throws InvalidInput unless 2 ≤ nodes ≤ 5.
LobattoRule lobatto_rule(int nodes);

}  // namespace modcal::event
