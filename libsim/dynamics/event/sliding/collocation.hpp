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

}  // namespace modcal::event
