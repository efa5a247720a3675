// The friction equation at the nodes of a collocation step.
#pragma once

#include <algorithm>
#include <cmath>

#include "libsim/dynamics/event/sliding_model.hpp"

namespace modcal::event {

/// The sliding law continued below u = 0 by its tangent. Only trial steps that end behind a switch
/// get there; the step that is kept ends at the switch.
template <typename Law>
typename Law::Point continued(const Law& law, double speed) {
  if (speed >= 0.0) return law.at(speed);
  const auto rest = law.at(0.0);
  return {rest.force + rest.slope * speed, rest.slope, 0.0};
}

struct NodeValues {
  NodeVector speed{};     ///< u_i = side·v_c [m/s]
  NodeVector friction{};  ///< g(u_i) [N]
  NodeVector slope{};     ///< g'(u_i) [N s/m]
};

/// x ← x − A⁻¹ b by elimination; A and b are overwritten. A is I + (small), so that its diagonal
/// serves as pivots. False where a pivot vanishes.
template <int kSize>
bool subtract_solution(double (&a)[kSize][kSize], double (&b)[kSize], double* x) {
  for (int k = 0; k < kSize; ++k) {
    if (!(std::abs(a[k][k]) > 1e-12)) return false;
    const double inverse = 1.0 / a[k][k];
    a[k][k] = inverse;
    for (int i = k + 1; i < kSize; ++i) {
      const double factor = a[i][k] * inverse;
      for (int j = k + 1; j < kSize; ++j) a[i][j] -= factor * a[k][j];
      b[i] -= factor * b[k];
    }
  }
  for (int k = kSize; k-- > 0;) {
    for (int j = k + 1; j < kSize; ++j) b[k] -= a[k][j] * b[j];
    b[k] *= a[k][k];
    x[k] -= b[k];
  }
  return true;
}

// I + coupling·diag(slope), the Jacobian of the equations, with the slopes of nodes 2…s.
template <int kNodes>
void fill_jacobian(const NodeMatrix& coupling, const NodeVector& slope,
                   double (&jacobian)[kNodes - 1][kNodes - 1]) {
  for (int i = 0; i + 1 < kNodes; ++i) {
    for (int j = 0; j + 1 < kNodes; ++j) {
      jacobian[i][j] = coupling[i + 1][j + 1] * slope[j + 1] + (i == j ? 1.0 : 0.0);
    }
  }
}

template <int kNodes, typename Law>
bool solve_nodes_of(const Law& law, const NodeMatrix& coupling, const NodeVector& free,
                    NodeValues& values) {
  constexpr int kMaxIterations = 25;
  constexpr double kTight = 1e-15, kAcceptable = 1e-13;
  double scale[kNodes];
  for (int i = 1; i < kNodes; ++i) {
    double sum = 0.0, size = 0.0;
    for (int j = 0; j < kNodes; ++j) {
      sum += coupling[i][j];
      size += std::abs(coupling[i][j]);
    }
    values.speed[i] = free[i] - sum * values.friction[0];
    scale[i] = std::abs(free[i]) + size * values.friction[0];
  }
  double previous = HUGE_VAL;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    for (int i = 1; i < kNodes; ++i) {
      const auto point = continued(law, values.speed[i]);
      values.friction[i] = point.force;
      values.slope[i] = point.slope;
    }
    double residual[kNodes - 1];
    double worst = 0.0;
    for (int i = 1; i < kNodes; ++i) {
      double sum = values.speed[i] - free[i];
      for (int j = 0; j < kNodes; ++j) sum += coupling[i][j] * values.friction[j];
      residual[i - 1] = sum;
      // Below the tight bound nothing is left to compare: one test of the common case.
      if (!(std::abs(sum) <= kTight * scale[i])) {
        worst = std::max(worst, std::isfinite(sum) ? std::abs(sum) / scale[i] : HUGE_VAL);
      }
    }
    if (worst == 0.0 || (worst <= kAcceptable && worst >= 0.5 * previous)) return true;
    if (worst == HUGE_VAL) return false;
    previous = worst;
    double jacobian[kNodes - 1][kNodes - 1];
    fill_jacobian<kNodes>(coupling, values.slope, jacobian);
    if (!subtract_solution(jacobian, residual, &values.speed[1])) return false;
  }
  return false;
}

/// Solves u_i = free_i − Σ_j coupling_ij g(u_j) for the nodes 2…s by Newton's method; node 1 is
/// given in `values`. True when every equation holds to rounding.
template <typename Law>
bool solve_nodes(const Law& law, int nodes, const NodeMatrix& coupling, const NodeVector& free,
                 NodeValues& values) {
  switch (nodes) {
    case 2:
      return solve_nodes_of<2>(law, coupling, free, values);
    case 3:
      return solve_nodes_of<3>(law, coupling, free, values);
    case 4:
      return solve_nodes_of<4>(law, coupling, free, values);
    default:
      return solve_nodes_of<5>(law, coupling, free, values);
  }
}

}  // namespace modcal::event
