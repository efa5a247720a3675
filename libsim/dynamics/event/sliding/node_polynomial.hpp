// Polynomials through the nodes of a collocation step.
#pragma once

#include <algorithm>
#include <cmath>

#include "libsim/dynamics/event/sliding/collocation.hpp"

namespace modcal::event {

/// Power coefficients in θ of the friction through the nodes.
inline NodeVector friction_powers(const LobattoRule& rule, const NodeValues& values) {
  NodeVector powers{};
  for (int j = 0; j < rule.nodes; ++j) {
    for (int k = 0; k < rule.nodes; ++k) powers[k] += values.friction[j] * rule.power[j][k];
  }
  return powers;
}

/// Lowest control point of the Bézier polygon through the speeds: no speed in between is below.
inline double lowest_control(const LobattoRule& rule, const NodeVector& speed) {
  double lowest = HUGE_VAL;
  for (int i = 0; i < rule.nodes; ++i) {
    double control = 0.0;
    for (int j = 0; j < rule.nodes; ++j) control += rule.bernstein[i][j] * speed[j];
    lowest = std::min(lowest, control);
  }
  return lowest;
}

/// A polynomial of the friction that node i of the step at hand finds at θ = from + scale·c_i.
struct FrictionGuess {
  const NodeVector& powers;
  double from, scale;
};

/// Speeds of the nodes 2…s to start the solution from: as if the friction there were the guess's;
/// `values` gives that of node 1.
inline void guess_speeds(const LobattoRule& rule, const NodeMatrix& coupling,
                         const NodeVector& free, const FrictionGuess& guess, NodeValues& values) {
  NodeVector friction{};
  friction[0] = values.friction[0];
  for (int i = 1; i < rule.nodes; ++i) {
    const double theta = guess.from + guess.scale * rule.node[i];
    for (int k = rule.nodes; k-- > 0;) friction[i] = friction[i] * theta + guess.powers[k];
  }
  for (int i = 1; i < rule.nodes; ++i) {
    double sum = 0.0;
    for (int j = 0; j < rule.nodes; ++j) sum += coupling[i][j] * friction[j];
    values.speed[i] = free[i] - sum;
  }
}

}  // namespace modcal::event
