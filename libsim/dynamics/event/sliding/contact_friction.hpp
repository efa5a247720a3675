// Friction of the sliding contact as the collocation steps ask for it.
#pragma once

#include "libsim/dynamics/event/sliding/sliding_model.hpp"

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

/// Friction l·g(u) of the sliding speed alone.
template <typename Law>
class CurveFriction {
 public:
  CurveFriction(const Law& law, const LobattoRule& rule, double /*effective_mass*/)
      : law_(law), any_law_(law), nodes_(rule.nodes) {}

  /// Friction [N] and slope [N s/m] of node 1 at the start of a stretch.
  NodeFriction at(double speed, double load) const {
    const auto point = law_.at(speed);
    return {load * point.force, load * point.slope};
  }
  bool solve(const NodeMatrix& coupling, const NodeVector& free, double /*step*/,
             NodeValues& values) const {
    return solve_nodes(any_law_, nodes_, coupling, free, values);
  }
  /// The state at the part θ of the step solved last.
  void accept(double /*theta*/) const {}
  /// Powers of θ of the temperature rise [K] on the step accepted last, θ = 1 where that ended.
  std::span<const double> rise_powers() const { return {}; }
  /// Temperature rise [K].
  double rise() const { return 0.0; }
  void set_rise(double /*rise*/) const {}
  /// Rests for a time [s].
  void cool(double /*time*/) const {}

 private:
  Law law_;
  SlidingLaw any_law_;
  int nodes_;
};

/// Friction l·μ(ϑ) of a contact that heats up while it slides, H ϑ' = l μ(ϑ) u − (G + S u) ϑ, the
/// load l being the normal force [N]. ϑ is collocated at the nodes of the force (Lobatto IIIA), so
/// that both keep the order of the nodes: with A the matrix ∫₀^{c_i} ℓ_j,
///   u_i = free_i − Σ_j coupling_ij l_j μ(ϑ_j),   ϑ_i = ϑ_1 + h Σ_j A_ij ϑ'(ϑ_j, u_j, l_j).
class ThermalFriction {
 public:
  ThermalFriction(const ThermalSliding& law, const LobattoRule& rule, double effective_mass);

  /// The slope is −m_eff times the fastest rate of heat and speed, √(|μ'| μ l²/(m_eff H)) of
  /// their feedback or (G + S u − l μ' u)/H of the temperature alone: the steps then resolve it as
  /// they do a falling curve's.
  NodeFriction at(double speed, double load) const;
  /// Solves for the nodes 2…s by Newton's method; true when every equation holds to rounding.
  bool solve(const NodeMatrix& coupling, const NodeVector& free, double step, NodeValues& values);
  void accept(double theta);
  std::span<const double> rise_powers() const { return powers_; }
  double rise() const { return rise_; }
  void set_rise(double rise) { rise_ = rise; }
  void cool(double time);

 private:
  // One node: what its equations and their derivatives need.
  struct Heating {
    double rate = 0.0;                       // ϑ' [K/s]
    double by_rise = 0.0, by_speed = 0.0;    // ∂ϑ'/∂ϑ, ∂ϑ'/∂u
    double friction = 0.0, softening = 0.0;  // l μ, l μ'
  };
  Heating heating(double rise, double speed, double load) const;
  double slope(const Heating& at) const;
  void evaluate(const NodeMatrix& coupling, const NodeVector& free, NodeValues& values);
  double newton_step(const NodeMatrix& coupling, double step);

  ThermalSliding law_;
  LobattoRule rule_;
  NodeMatrix integral_{};  // A
  double effective_mass_;
  double rise_;
  // The step solved last.
  double step_ = 0.0;
  NodeVector node_rise_{};
  std::array<Heating, kMaxNodes> node_{};
  std::array<double, kMaxNodes + 1> powers_{};  // of the step accepted last
};

}  // namespace modcal::event
