// The friction equation at the nodes of a collocation step.
#pragma once

#include "libsim/dynamics/event/sliding/sliding_model.hpp"
#include "libsim/dynamics/friction/sliding_laws.hpp"

namespace modcal::event {

/// Friction [N] and its slope [N s/m] at one node.
struct NodeFriction {
  double friction = 0.0, slope = 0.0;
};

struct NodeValues {
  NodeVector speed{};     ///< u_i = side·v_c [m/s]
  NodeVector load{};      ///< l_i ≥ 0, the factor of the law at the node
  NodeVector friction{};  ///< l_i g(u_i) [N]
  NodeVector slope{};     ///< l_i g'(u_i) [N s/m], or what the steps must resolve in its place
};

/// Solves u_i = free_i − Σ_j coupling_ij l_j g(u_j) for the nodes 2…s by Newton's method; `values`
/// gives node 1, the loads and the speeds to start from. True when every equation holds to
/// rounding. Kernel: the instruction set is chosen at run time.
///
/// Below u = 0 the law is continued by its parabola as far as its slope doubles, by the tangent
/// beyond: only trial steps that end behind a switch get
/// there; the step that is kept ends at the switch.
bool solve_nodes(const SlidingLaw& law, int nodes, const NodeMatrix& coupling,
                 const NodeVector& free, NodeValues& values);

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
