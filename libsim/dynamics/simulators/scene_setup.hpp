// What every simulator sets up in the same way: the contact of a scene and the signals of a result.
#pragma once

#include "libsim/dynamics/simulator.hpp"
#include "libsim/dynamics/step_loop.hpp"

namespace modcal {

/// Contact of the scene; a near-critical adherence damping becomes C_a = 2 √(K_a m_eff).
ContactParameters contact_parameters(const Scene& scene, const FrictionLaw& friction,
                                     double effective_mass);

/// A result whose asked-for signals have `count` zeros.
Simulation empty_simulation(std::size_t count, double rate, const OutputRequest& outputs);

/// Where the samples of its signals are.
SampleTargets targets_of(Simulation& result);

}  // namespace modcal
