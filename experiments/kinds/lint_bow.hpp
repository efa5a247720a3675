// Mistakes in how a bow is moved.
#pragma once

#include "experiments/experiment.hpp"

namespace modcal {

/// Speeds and forces of no hand, gestures that cannot be or that begin behind the scene.
void lint_bow(const Scene& scene, std::vector<Finding>& findings);

}  // namespace modcal
