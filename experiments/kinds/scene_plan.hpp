// What a simulation will do, said before it is done.
#pragma once

#include <string>
#include <vector>

#include "libsim/dynamics/scene.hpp"

namespace modcal {

/// Samples, modes that move and modes that a node at the contact leaves at rest.
std::vector<std::string> plan_scene(const Scene& scene, double sample_rate,
                                    std::size_t simulations);

}  // namespace modcal
