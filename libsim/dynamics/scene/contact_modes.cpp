#include "libsim/dynamics/scene/contact_modes.hpp"

#include <cmath>
#include <numeric>

#include "libsim/base/error.hpp"
#include "libsim/model/transfer.hpp"

namespace modcal {
namespace {

constexpr double kNodeTolerance = 1e-13;
constexpr double kNodeShape = 1e-20;

void require_matching(const ModalState& initial, std::size_t modes) {
  for (const std::vector<double>* part : {&initial.displacement, &initial.velocity}) {
    MODCAL_REQUIRE(part->empty() || part->size() == modes,
                   "the initial state has {} modal values for {} modes", part->size(), modes);
  }
}

double value_or_zero(const std::vector<double>& values, std::size_t index) {
  return values.empty() ? 0.0 : values[index];
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

bool is_node(double shape) { return std::abs(shape) <= kNodeTolerance; }

ContactModes contact_modes(const ModalBasis& basis, double contact, const ModalState& initial) {
  require_matching(initial, basis.size());
  const std::vector<double> shape = basis.shape_at(contact);
  const std::vector<double> left = reaction_gains(basis, End::kLeft);
  const std::vector<double> right = reaction_gains(basis, End::kRight);
  ContactModes modes;
  bool moves = false;
  for (std::size_t n = 0; n < basis.size(); ++n) {
    moves = moves || !is_node(shape[n]);
    const double q = value_or_zero(initial.displacement, n);
    const double p = value_or_zero(initial.velocity, n);
    if (is_node(shape[n]) && q == 0.0 && p == 0.0) {
      modes.left_out.push_back(n);
      continue;
    }
    const double phi = is_node(shape[n]) ? kNodeShape : shape[n];
    const double decay = basis.zeta[n] * basis.omega[n];
    const double damped = basis.omega[n] * std::sqrt(1.0 - basis.zeta[n] * basis.zeta[n]);
    modes.pole.emplace_back(-decay, damped);
    modes.drive.push_back(phi * phi / basis.mass[n]);
    modes.quadrature.push_back(decay / damped);
    modes.compliance.push_back(1.0 / damped);
    modes.left_gain.push_back(left[n] / (phi * damped));
    modes.right_gain.push_back(right[n] / (phi * damped));
    modes.initial.emplace_back(phi * (p + decay * q), phi * damped * q);
  }
  MODCAL_REQUIRE(moves,
                 "every mode has a node at the contact point {:g} m: nothing can move there; move "
                 "the bow",
                 contact);
  return modes;
}

}  // namespace modcal
