#include "libsim/dynamics/scene/driven_structure.hpp"

#include <algorithm>

namespace modcal {
namespace {

// Whether a mode is seen by nobody.
bool is_silent(const DrivenStructure& structure, std::size_t n) {
  const ModalModel& model = structure.model;
  if (structure.drive[n] > 0.0) return false;
  for (std::size_t k = 0; k < model.pairs(); ++k) {
    const std::size_t i = k * model.poles.size() + n;
    if (model.constants[i] != 0.0) return false;
    if (!model.quadrature.empty() && model.quadrature[i] != 0.0) return false;
  }
  return true;
}

// Modes that move, as the contact drives them; no readings yet. `kept`: their numbers.
ContactModes driven_modes(const DrivenStructure& structure, std::vector<std::size_t>& kept) {
  const std::vector<ModalPole>& poles = structure.model.poles;
  MODCAL_REQUIRE(structure.drive.size() == poles.size(), "{} values at the contact for {} modes",
                 structure.drive.size(), poles.size());
  const double most = poles.empty() ? 0.0 : *std::ranges::max_element(structure.drive);
  MODCAL_REQUIRE(most > 0.0, "no mode moves at the contact: it needs phi^2/m > 0 of one at least");
  ContactModes modes;
  for (std::size_t n = 0; n < poles.size(); ++n) {
    const auto [omega, zeta] = poles[n];
    MODCAL_REQUIRE(structure.drive[n] >= 0.0,
                   "phi^2/m of the mode at {:g} Hz is {:g} /kg at the contact: it is no square",
                   omega / (2.0 * std::numbers::pi), structure.drive[n]);
    if (is_silent(structure, n)) {
      modes.left_out.push_back(n);
      continue;
    }
    const double decay = zeta * omega, damped = omega * std::sqrt(1.0 - zeta * zeta);
    modes.pole.emplace_back(-decay, damped);
    modes.quadrature.push_back(decay / damped);
    modes.compliance.push_back(1.0 / damped);
    modes.initial.emplace_back(0.0);
    // A mode with a node at the contact is driven, and below any rounding of what the contact
    // feels.
    modes.drive.push_back(std::max(structure.drive[n], 1e-40 * most));
    kept.push_back(n);
  }
  return modes;
}

// g of Re(ḡ Z) = (α u + β u')/d with u = Im Z/ω_d, u' = Re Z − ζω/ω_d Im Z.
Complex gain_of(const DrivenStructure& structure, const ContactModes& modes, std::size_t sensor,
                std::size_t mode, std::size_t n) {
  const ModalModel& model = structure.model;
  const auto [omega, zeta] = model.poles[n];
  const double real = model.constant(sensor, n);
  const double turned =
      model.quadrature.empty() ? 0.0 : model.quadrature[sensor * model.poles.size() + n];
  double alpha = real, beta = turned / omega;
  if (const int power = power_of_s(model.sensors[sensor]); power == 1) {
    alpha = -turned * omega;
    beta = real;
  } else if (power == 2) {
    // u'' without the force's own share.
    alpha = -real * omega * omega;
    beta = -2.0 * zeta * omega * real - turned * omega;
  }
  return Complex(beta, alpha * modes.compliance[mode] - beta * modes.quadrature[mode]) /
         modes.drive[mode];
}

// What a sensor reads of the force at once.
double direct_share(const ModalModel& model, std::size_t sensor) {
  double share = 0.0;
  const int power = power_of_s(model.sensors[sensor]);
  if (power == 2) {
    for (std::size_t n = 0; n < model.poles.size(); ++n) share += model.constant(sensor, n);
  }
  if (!model.residuals.empty()) {
    share += power == 2   ? model.residuals[sensor].below
             : power == 0 ? model.residuals[sensor].constant
                          : 0.0;
  }
  return share;
}

}  // namespace

ModalModel simulated_part(ModalModel model) {
  for (std::size_t k = 0; k < model.residuals.size(); ++k) {
    const int power = power_of_s(model.sensors[k / model.contacts]);
    ResidualTerms& terms = model.residuals[k];
    terms = {.below = power == 2 ? terms.below : 0.0,
             .constant = power == 0 ? terms.constant : 0.0};
  }
  return model;
}

StructureSimulation simulate_structure(const Simulator& simulator, Scene scene,
                                       const DrivenStructure& structure, double sample_rate,
                                       const StopToken& stop) {
  MODCAL_REQUIRE(structure.model.contacts == 1, "{} contacts: the bow has one",
                 structure.model.contacts);
  std::vector<std::size_t> kept;
  ContactModes modes = driven_modes(structure, kept);
  const std::size_t sensors = structure.model.sensors.size();
  StructureSimulation result;
  for (std::size_t first = 0; first == 0 || first < sensors; first += 2) {
    const auto gains = [&](std::size_t sensor) {
      std::vector<Complex> all(modes.size());
      for (std::size_t i = 0; i < all.size() && sensor < sensors; ++i) {
        all[i] = gain_of(structure, modes, sensor, i, kept[i]);
      }
      return all;
    };
    modes.left_gain = gains(first);
    modes.right_gain = gains(first + 1);
    scene.structure = std::make_shared<const ContactModes>(modes);
    OutputRequest outputs = OutputRequest::all();
    if (first == 0) outputs.switches_from = 0.0;
    Simulation run = simulator.simulate(scene, sample_rate, outputs, stop);
    for (std::size_t k = first; k < std::min(first + 2, sensors) && !run.diverged_at; ++k) {
      Signal& read = k == first ? run.left_reaction : run.right_reaction;
      const double share = direct_share(structure.model, k);
      for (std::size_t j = 0; j < read.size(); ++j) read.samples[j] += share * run.force.samples[j];
      result.sensors.push_back(std::move(read.samples));
    }
    run.left_reaction = run.right_reaction = {};
    if (first == 0) result.contact = std::move(run);
    if (result.contact.diverged_at) break;
  }
  return result;
}

}  // namespace modcal
