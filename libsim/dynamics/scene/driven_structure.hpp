// Any structure in the place of the string: its modes as a contact drives them, and what its
// sensors read.
#pragma once

#include "libsim/dynamics/scene/contact_modes.hpp"
#include "libsim/dynamics/scene/simulator.hpp"
#include "libsim/model/modal_model.hpp"

namespace modcal {

/// A modal model with one contact, and how that contact itself moves.
struct DrivenStructure {
  ModalModel model;           ///< from the contact to K sensors
  std::vector<double> drive;  ///< φ_n²/m_n at the contact, 0 at a node [1/kg]
};

/// The model without the static terms that are no part of a simulation, which would differentiate
/// or integrate the force: what is left of them is c_0 of displacements, strains and forces and
/// c_−2 of accelerations, a share of the force itself.
ModalModel simulated_part(ModalModel model);

/// What the contact and the sensors do.
struct StructureSimulation {
  Simulation contact;                        ///< without reactions; its switches are listed
  std::vector<std::vector<double>> sensors;  ///< K; none where the simulation could not go on
};

/// The scene's bow and friction on a structure: with u_n the contact's displacement in mode n,
///   u_n'' + 2 ζ_n ω_n u_n' + ω_n² u_n = (φ_n²/m_n) f_c,   y = Σ u_n,
/// sensors of displacement (strain, force) read Σ (Re A_n u_n + Im A_n u_n'/ω_n)/d_n + c_0 f_c, of
/// velocity Σ (Re A_n u_n' − Im A_n ω_n u_n)/d_n, of acceleration Σ (Re A_n u_n'' − Im A_n ω_n
/// u_n')/d_n + c_−2 f_c, d_n = φ_n²/m_n: the transfer functions of simulated_part(model). String,
/// bow.position and initial motion of the scene do not count. Runs the simulator once for two
/// sensors; the force is the same to the last bit. Throws InvalidInput where a d_n is negative or
/// all are 0, or the simulator cannot take the scene.
StructureSimulation simulate_structure(const Simulator& simulator, Scene scene,
                                       const DrivenStructure& structure, double sample_rate,
                                       const StopToken& stop = {});

}  // namespace modcal
