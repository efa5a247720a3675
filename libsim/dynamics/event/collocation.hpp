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
  return {rest.force + rest.slope * speed, rest.slope};
}

struct NodeValues {
  NodeVector speed{};     ///< u_i = side·v_c [m/s]
  NodeVector friction{};  ///< g(u_i) [N]
  NodeVector slope{};     ///< g'(u_i) [N s/m]
};

/// Solves A x = b of order `size` in place by elimination; the matrix is I + (small), so that its
/// diagonal serves as pivots. False where a pivot vanishes.
inline bool solve_small(std::array<NodeVector, kMaxNodes>& a, NodeVector& b, int size) {
  for (int k = 0; k < size; ++k) {
    if (!(std::abs(a[k][k]) > 1e-12)) return false;
    const double inverse = 1.0 / a[k][k];
    for (int i = k + 1; i < size; ++i) {
      const double factor = a[i][k] * inverse;
      for (int j = k + 1; j < size; ++j) a[i][j] -= factor * a[k][j];
      b[i] -= factor * b[k];
    }
  }
  for (int k = size; k-- > 0;) {
    for (int j = k + 1; j < size; ++j) b[k] -= a[k][j] * b[j];
    b[k] /= a[k][k];
  }
  return true;
}

/// Solves u_i = free_i − Σ_j coupling_ij g(u_j) for the nodes 2…s by Newton's method; node 1 is
/// given in `values`. True when every equation holds to rounding.
template <typename Law>
bool solve_nodes(const Law& law, int nodes, const NodeMatrix& coupling, const NodeVector& free,
                 NodeValues& values) {
  constexpr int kMaxIterations = 25;
  constexpr double kTight = 1e-15, kAcceptable = 1e-13;
  const int unknowns = nodes - 1;
  NodeVector scale{};
  for (int i = 1; i < nodes; ++i) {
    double sum = 0.0, size = 0.0;
    for (int j = 0; j < nodes; ++j) {
      sum += coupling[i][j];
      size += std::abs(coupling[i][j]);
    }
    values.speed[i] = free[i] - sum * values.friction[0];
    scale[i] = std::abs(free[i]) + size * values.friction[0];
  }
  double previous = HUGE_VAL;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    for (int i = 1; i < nodes; ++i) {
      const auto point = continued(law, values.speed[i]);
      values.friction[i] = point.force;
      values.slope[i] = point.slope;
    }
    NodeVector residual{};
    double worst = 0.0;
    for (int i = 1; i < nodes; ++i) {
      double sum = values.speed[i] - free[i];
      for (int j = 0; j < nodes; ++j) sum += coupling[i][j] * values.friction[j];
      residual[i - 1] = sum;
      worst = std::max(worst, std::abs(sum) / scale[i]);
    }
    if (worst <= kTight || (worst <= kAcceptable && worst >= 0.5 * previous)) return true;
    if (!(worst < HUGE_VAL)) return false;
    previous = worst;
    std::array<NodeVector, kMaxNodes> jacobian;
    for (int i = 0; i < unknowns; ++i) {
      for (int j = 0; j < unknowns; ++j) {
        jacobian[i][j] = coupling[i + 1][j + 1] * values.slope[j + 1] + (i == j ? 1.0 : 0.0);
      }
    }
    if (!solve_small(jacobian, residual, unknowns)) return false;
    for (int i = 1; i < nodes; ++i) values.speed[i] -= residual[i - 1];
  }
  return false;
}

}  // namespace modcal::event
