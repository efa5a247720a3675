#include "libsim/dynamics/scene/contact_modes.hpp"

#include <numeric>

#include "libsim/dynamics/scene/tuning.hpp"
#include "libsim/model/transfer.hpp"

namespace modcal {
namespace {

using Shapes = std::vector<std::vector<double>>;  // points × modes

Shapes shapes_at(const ModalBasis& basis, std::span<const double> positions) {
  Shapes shapes;
  for (const double x : positions) shapes.push_back(basis.shape_at(x));
  return shapes;
}

void require_matching(const ModalState& initial, std::size_t modes) {
  for (const std::vector<double>* part : {&initial.displacement, &initial.velocity}) {
    MODCAL_REQUIRE(part->empty() || part->size() == modes,
                   "the initial state has {} modal values for {} modes", part->size(), modes);
  }
}

double value_or_zero(const std::vector<double>& values, std::size_t index) {
  return values.empty() ? 0.0 : values[index];
}

// Adds the modes that move at one of the points, or initially, to `table`: add(n) adds what else is
// kept of mode n and returns the φ of its variable. Returns the modes left out.
template <typename Add>
std::vector<std::size_t> add_modes(const ModalBasis& basis, std::span<const double> positions,
                                   const Shapes& shapes, const ModalState& initial,
                                   ModeTable& table, const Add& add) {
  require_matching(initial, basis.size());
  const std::vector<double> left = reaction_gains(basis, End::kLeft);
  const std::vector<double> right = reaction_gains(basis, End::kRight);
  std::vector<std::size_t> left_out;
  bool moves = false;
  for (std::size_t n = 0; n < basis.size(); ++n) {
    const bool reached = std::any_of(shapes.begin(), shapes.end(),
                                     [n](const auto& shape) { return !is_node(shape[n]); });
    moves = moves || reached;
    const double q = value_or_zero(initial.displacement, n);
    const double p = value_or_zero(initial.velocity, n);
    if (!reached && q == 0.0 && p == 0.0) {
      left_out.push_back(n);
      continue;
    }
    const double phi = add(n);
    const double decay = basis.zeta[n] * basis.omega[n];
    const double damped = basis.omega[n] * std::sqrt(1.0 - basis.zeta[n] * basis.zeta[n]);
    table.pole.emplace_back(-decay, damped);
    table.quadrature.push_back(decay / damped);
    table.compliance.push_back(1.0 / damped);
    table.left_gain.emplace_back(0.0, left[n] / (phi * damped));
    table.right_gain.emplace_back(0.0, right[n] / (phi * damped));
    table.initial.emplace_back(phi * (p + decay * q), phi * damped * q);
  }
  MODCAL_REQUIRE(moves,
                 "every mode has a node at the contact point {:g} m: nothing can move there; move "
                 "the bow",
                 positions.front());
  return left_out;
}

void add_line_modes(const ModalBasis& basis, std::span<const double> positions,
                    const ModalState& initial, LineModes& modes) {
  const Shapes shapes = shapes_at(basis, positions);
  add_modes(basis, positions, shapes, initial, modes, [&](std::size_t n) {
    modes.inverse_mass.push_back(1.0 / basis.mass[n]);
    for (std::size_t j = 0; j < shapes.size(); ++j) {
      // A node is exact but for rounding of nπx/L.
      modes.shape[j].push_back(is_node(shapes[j][n]) ? 0.0 : shapes[j][n]);
    }
    return 1.0;
  });
}

// One point, φ = 1.
LineModes line_of(const ContactModes& modes) {
  LineModes line{modes, modes.drive, {std::vector<double>(modes.size(), 1.0)}};
  return line;
}

}  // namespace

void ContactModes::append(const ContactModes& other) {
  const auto join = [](auto& values, const auto& more) {
    values.insert(values.end(), more.begin(), more.end());
  };
  join(pole, other.pole);
  join(drive, other.drive);
  join(quadrature, other.quadrature);
  join(compliance, other.compliance);
  join(left_gain, other.left_gain);
  join(right_gain, other.right_gain);
  join(initial, other.initial);
}

double ContactModes::effective_mass() const {
  return 1.0 / std::accumulate(drive.begin(), drive.end(), 0.0);
}

double LineModes::effective_mass() const {
  double mobility = 0.0;
  for (const std::vector<double>& one : shape) {
    for (std::size_t n = 0; n < size(); ++n) mobility += one[n] * one[n] * inverse_mass[n];
  }
  return static_cast<double>(points()) / mobility;
}

bool is_node(double shape) { return std::abs(shape) <= kNodeTolerance; }

ContactModes contact_modes(const ModalBasis& basis, double contact, const ModalState& initial) {
  ContactModes modes;
  const Shapes shapes = shapes_at(basis, {&contact, 1});
  modes.left_out = add_modes(basis, {&contact, 1}, shapes, initial, modes, [&](std::size_t n) {
    const double phi = is_node(shapes[0][n]) ? kNodeStandIn : shapes[0][n];
    modes.drive.push_back(phi * phi / basis.mass[n]);
    return phi;
  });
  return modes;
}

MotionSample motion_of(const ContactModes& modes, const std::vector<std::complex<double>>& state) {
  MotionSample sum;
  for (std::size_t n = 0; n < modes.size(); ++n) {
    const MotionSample part = modes.motion(n, state[n]);
    for (const auto of : {&MotionSample::displacement, &MotionSample::velocity, &MotionSample::left,
                          &MotionSample::right}) {
      sum.*of += part.*of;
    }
  }
  return sum;
}

ContactModes scene_modes(const Scene& scene) {
  MODCAL_REQUIRE(scene.bow.contact_points().size() == 1,
                 "{} contact points over {:g} m: this simulator has one; use modal_exact or "
                 "newmark_explicit, or a bow of width 0",
                 scene.bow.points, scene.bow.width);
  if (scene.structure != nullptr) return *scene.structure;
  const ModalBasis basis = make_modal_basis(scene.string);
  ContactModes modes = contact_modes(basis, scene.bow.position, initial_state(scene, basis));
  if (scene.torsion.present) {
    const ModalBasis torsional = scene.torsion.basis(basis, scene.string.wave_speed());
    modes.append(contact_modes(torsional, scene.bow.position, {}));
  }
  return modes;
}

LineModes scene_line_modes(const Scene& scene) {
  if (scene.structure != nullptr) return line_of(scene_modes(scene));
  const ModalBasis basis = make_modal_basis(scene.string);
  const std::vector<double> positions = scene.bow.contact_points();
  for (const double x : positions) {
    MODCAL_REQUIRE(x > 0.0 && x < basis.length,
                   "contact point {:g} m is not inside the string of {:g} m: move the bow or make "
                   "it narrower",
                   x, basis.length);
  }
  LineModes modes;
  modes.shape.resize(positions.size());
  add_line_modes(basis, positions, initial_state(scene, basis), modes);
  if (scene.torsion.present) {
    const ModalBasis torsional = scene.torsion.basis(basis, scene.string.wave_speed());
    add_line_modes(torsional, positions, {}, modes);
  }
  return modes;
}

ContactParameters contact_parameters(const BowMotion& motion, const FrictionLaw& friction,
                                     double effective_mass) {
  const Adherence& adherence = friction.adherence();
  const bool near_critical = std::isnan(adherence.damping);
  return {.bow_velocity = motion.velocity.at(0.0),
          .static_limit = friction.static_limit(motion.normal_force.at(0.0)),
          .stiffness = adherence.stiffness,
          .damping = near_critical ? 2.0 * std::sqrt(adherence.stiffness * effective_mass)
                                   : adherence.damping};
}

}  // namespace modcal
