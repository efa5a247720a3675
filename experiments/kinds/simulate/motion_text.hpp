// What a string did, in words.
#pragma once

#include <string>

#include "libsim/dynamics/scene/simulator.hpp"

namespace modcal {

/// In a sentence, what the string does at the end of a simulation, whose velocity is needed: the
/// regime under a steady bow, with frequency and friction force, or a free decay.
std::string motion_text(const Scene& scene, const Simulation& simulation);

}  // namespace modcal
