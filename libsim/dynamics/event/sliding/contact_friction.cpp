#include "libsim/dynamics/event/sliding/contact_friction.hpp"

#include "libsim/dynamics/event/sliding/tuning.hpp"

namespace modcal::event {
namespace {

using System = std::array<NodeVector, kMaxNodes>;

// x ← A⁻¹ x by elimination with partial pivoting; false where A is singular.
bool solve_system(System& a, NodeVector& x, int size) {
  for (int k = 0; k < size; ++k) {
    int pivot = k;
    for (int i = k + 1; i < size; ++i) {
      if (std::abs(a[i][k]) > std::abs(a[pivot][k])) pivot = i;
    }
    std::swap(a[k], a[pivot]);
    std::swap(x[k], x[pivot]);
    if (!(std::abs(a[k][k]) > 1e-12)) return false;
    for (int i = k + 1; i < size; ++i) {
      const double factor = a[i][k] / a[k][k];
      for (int j = k; j < size; ++j) a[i][j] -= factor * a[k][j];
      x[i] -= factor * x[k];
    }
  }
  for (int k = size; k-- > 0;) {
    for (int j = k + 1; j < size; ++j) x[k] -= a[k][j] * x[j];
    x[k] /= a[k][k];
  }
  return true;
}

// Weights of ∫₀^θ of the polynomial through the nodes, θ in parts of the step.
NodeVector integral_weights(const LobattoRule& rule, double theta) {
  NodeVector weights{};
  for (int j = 0; j < rule.nodes; ++j) {
    double power = theta;
    for (int k = 0; k < rule.nodes; ++k) {
      weights[j] += rule.power[j][k] * power / (k + 1.0);
      power *= theta;
    }
  }
  return weights;
}

}  // namespace

ThermalFriction::ThermalFriction(const ThermalSliding& law, const LobattoRule& rule,
                                 double effective_mass)
    : law_(law), rule_(rule), effective_mass_(effective_mass), rise_(law.rise) {
  for (int i = 0; i < rule.nodes; ++i) integral_[i] = integral_weights(rule, rule.node[i]);
}

ThermalFriction::Heating ThermalFriction::heating(double rise, double speed, double load) const {
  const ThermalSliding::Softening mu = law_.softening_at(rise);
  const double inverse = 1.0 / law_.capacity;
  Heating at;
  at.friction = load * mu.coefficient;
  at.softening = load * mu.slope;
  const double loss = law_.conductance + law_.carried * speed;
  at.rate = (at.friction * speed - loss * rise) * inverse;
  at.by_rise = (at.softening * speed - loss) * inverse;
  at.by_speed = (at.friction - law_.carried * rise) * inverse;
  return at;
}

double ThermalFriction::slope(const Heating& at) const {
  const double feedback =
      std::sqrt(-at.softening * at.friction / (effective_mass_ * law_.capacity));
  return -effective_mass_ * std::max(feedback, std::abs(at.by_rise));
}

NodeFriction ThermalFriction::at(double speed, double load) const {
  const Heating here = heating(rise_, speed, load);
  return {here.friction, slope(here)};
}

// Speeds and heating of the nodes at their temperatures.
void ThermalFriction::evaluate(const NodeMatrix& coupling, const NodeVector& free,
                               NodeValues& values) {
  for (int i = 1; i < rule_.nodes; ++i) {
    values.friction[i] = values.load[i] * law_.softening_at(node_rise_[i]).coefficient;
  }
  for (int i = 1; i < rule_.nodes; ++i) {
    values.speed[i] = free[i];
    for (int j = 0; j < rule_.nodes; ++j) values.speed[i] -= coupling[i][j] * values.friction[j];
    node_[i] = heating(node_rise_[i], values.speed[i], values.load[i]);
  }
}

// Corrects the temperatures of the nodes; the largest correction [K], infinite where there is none.
double ThermalFriction::newton_step(const NodeMatrix& coupling, double step) {
  System jacobian{};
  NodeVector residual{};
  const int unknowns = rule_.nodes - 1;
  for (int i = 1; i < rule_.nodes; ++i) {
    residual[i - 1] = node_rise_[i] - rise_;
    for (int j = 0; j < rule_.nodes; ++j) {
      residual[i - 1] -= step * integral_[i][j] * node_[j].rate;
    }
    for (int k = 1; k < rule_.nodes; ++k) {
      double derivative = integral_[i][k] * node_[k].by_rise;
      for (int j = 1; j < rule_.nodes; ++j) {
        derivative -= integral_[i][j] * node_[j].by_speed * coupling[j][k] * node_[k].softening;
      }
      jacobian[i - 1][k - 1] = (i == k ? 1.0 : 0.0) - step * derivative;
    }
  }
  if (!solve_system(jacobian, residual, unknowns)) return HUGE_VAL;
  double largest = 0.0;
  for (int i = 1; i < rule_.nodes; ++i) {
    node_rise_[i] -= residual[i - 1];
    largest =
        std::max(largest, std::isfinite(residual[i - 1]) ? std::abs(residual[i - 1]) : HUGE_VAL);
  }
  return largest;
}

bool ThermalFriction::solve(const NodeMatrix& coupling, const NodeVector& free, double step,
                            NodeValues& values) {
  step_ = step;
  node_rise_[0] = rise_;
  node_[0] = heating(rise_, values.speed[0], values.load[0]);
  for (int i = 1; i < rule_.nodes; ++i) {
    node_rise_[i] = rise_ + step * rule_.node[i] * node_[0].rate;
  }
  const double width = law_.softening_width;
  double previous = HUGE_VAL;
  for (int iteration = 0; iteration < kNewtonSteps; ++iteration) {
    evaluate(coupling, free, values);
    const double change = newton_step(coupling, step);
    if (change == HUGE_VAL) return false;
    const double share = change / (width + std::abs(rise_));
    const bool settled =
        share <= kTightThermal || (share <= kAcceptableNodes && change >= 0.5 * previous);
    // What a correction leaves is about its square.
    if (settled || share * share <= 0.01 * kTightThermal) {
      evaluate(coupling, free, values);
      for (int i = 1; i < rule_.nodes; ++i) values.slope[i] = slope(node_[i]);
      return true;
    }
    previous = change;
  }
  return false;
}

void ThermalFriction::cool(double time) {
  rise_ *= std::exp(-law_.conductance / law_.capacity * time);
}

void ThermalFriction::accept(double theta) {
  powers_ = {rise_};
  double scale = step_ * theta;
  for (int k = 0; k < rule_.nodes; ++k) {
    for (int j = 0; j < rule_.nodes; ++j) powers_[k + 1] += rule_.power[j][k] * node_[j].rate;
    powers_[k + 1] *= scale / (k + 1.0);
    scale *= theta;
  }
  const NodeVector weights = integral_weights(rule_, theta);
  double sum = 0.0;
  for (int j = 0; j < rule_.nodes; ++j) sum += weights[j] * node_[j].rate;
  rise_ = std::max(0.0, rise_ + step_ * sum);
}

}  // namespace modcal::event
