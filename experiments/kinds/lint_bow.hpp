// Mistakes in how a bow is moved.
#pragma once

#include "experiments/experiment.hpp"

namespace modcal {

/// Speeds and forces of no hand, gestures that cannot be or that begin behind the scene.
/// path: of the bow, beside which its scene states the duration [s].
void lint_bow(const std::string& path, const Bow& bow, double duration,
              std::vector<Finding>& findings);

}  // namespace modcal
