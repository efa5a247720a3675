// What every simulator sets up in the same way: the contact of a scene and the signals of a result.
#pragma once

#include "libsim/dynamics/fixed_step/line_modes.hpp"
#include "libsim/dynamics/scene/simulator.hpp"
#include "libsim/dynamics/fixed_step/step_loop.hpp"

namespace modcal {

/// The modes of the scene's string as one contact point sees them, the torsional ones last. Throws
/// InvalidInput for a bow with several contact points.
ContactModes scene_modes(const Scene& scene);

/// The same as all contact points of the bow see them.
LineModes scene_line_modes(const Scene& scene);

/// Motion of a bow that must be steady. Throws InvalidInput for any other, in the name of the
/// simulator.
BowMotion steady_motion(const Scene& scene, std::string_view simulator);

/// Contact of the scene under a bow that moves as at t = 0; a near-critical adherence damping
/// becomes C_a = 2 √(K_a m_eff).
ContactParameters contact_parameters(const BowMotion& motion, const FrictionLaw& friction,
                                     double effective_mass);

/// A result whose asked-for signals have `count` zeros.
Simulation empty_simulation(std::size_t count, double rate, const OutputRequest& outputs);

/// Where the samples of its signals are.
SampleTargets targets_of(Simulation& result);

}  // namespace modcal
