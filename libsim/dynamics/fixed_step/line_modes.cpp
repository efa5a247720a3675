#include "libsim/dynamics/fixed_step/line_modes.hpp"

#include <algorithm>
#include <cmath>

#include "libsim/base/error.hpp"
#include "libsim/dynamics/scene/contact_modes.hpp"
#include "libsim/model/transfer.hpp"

namespace modcal {
namespace {

double value_or_zero(const std::vector<double>& values, std::size_t index) {
  return values.empty() ? 0.0 : values[index];
}

using Shapes = std::vector<std::vector<double>>;  // points × modes

Shapes shapes_at(const ModalBasis& basis, std::span<const double> positions) {
  Shapes shapes;
  for (const double x : positions) shapes.push_back(basis.shape_at(x));
  return shapes;
}

struct Gains {
  double left = 0.0, right = 0.0;
};

void append(const ModalBasis& basis, std::size_t n, const Shapes& shapes, Gains gains, double q,
            double p, LineModes& modes) {
  const double decay = basis.zeta[n] * basis.omega[n];
  const double damped = basis.omega[n] * std::sqrt(1.0 - basis.zeta[n] * basis.zeta[n]);
  modes.pole.emplace_back(-decay, damped);
  modes.inverse_mass.push_back(1.0 / basis.mass[n]);
  modes.quadrature.push_back(decay / damped);
  modes.compliance.push_back(1.0 / damped);
  modes.left_gain.push_back(gains.left / damped);
  modes.right_gain.push_back(gains.right / damped);
  modes.initial.emplace_back(p + decay * q, damped * q);
  for (std::size_t j = 0; j < shapes.size(); ++j) {
    // A node is exact but for rounding of nπx/L.
    modes.shape[j].push_back(is_node(shapes[j][n]) ? 0.0 : shapes[j][n]);
  }
}

bool reached(const Shapes& shapes, std::size_t n) {
  return std::any_of(shapes.begin(), shapes.end(),
                     [n](const std::vector<double>& shape) { return !is_node(shape[n]); });
}

}  // namespace

double LineModes::effective_mass() const {
  double mobility = 0.0;
  for (const std::vector<double>& one : shape) {
    for (std::size_t n = 0; n < size(); ++n) mobility += one[n] * one[n] * inverse_mass[n];
  }
  return static_cast<double>(points()) / mobility;
}

LineModes line_modes(const ModalBasis& transverse, const ModalBasis& torsional,
                     std::span<const double> positions, const ModalState& initial) {
  for (const double x : positions) {
    MODCAL_REQUIRE(x > 0.0 && x < transverse.length,
                   "contact point {:g} m is not inside the string of {:g} m: move the bow or make "
                   "it narrower",
                   x, transverse.length);
  }
  LineModes modes;
  modes.shape.resize(positions.size());
  const Shapes shapes = shapes_at(transverse, positions);
  const std::vector<double> left = reaction_gains(transverse, End::kLeft);
  const std::vector<double> right = reaction_gains(transverse, End::kRight);
  bool moves = false;
  for (std::size_t n = 0; n < transverse.size(); ++n) {
    const double q = value_or_zero(initial.displacement, n);
    const double p = value_or_zero(initial.velocity, n);
    moves = moves || reached(shapes, n);
    if (!reached(shapes, n) && q == 0.0 && p == 0.0) continue;
    append(transverse, n, shapes, {left[n], right[n]}, q, p, modes);
  }
  MODCAL_REQUIRE(moves,
                 "every mode has a node at the contact point {:g} m: nothing can move there; move "
                 "the bow",
                 positions.front());
  const Shapes turning = shapes_at(torsional, positions);
  for (std::size_t n = 0; n < torsional.size(); ++n) {
    if (reached(turning, n)) append(torsional, n, turning, {}, 0.0, 0.0, modes);
  }
  return modes;
}

}  // namespace modcal
