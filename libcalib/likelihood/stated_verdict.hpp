// What priors say of the modes.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "libcalib/likelihood/continuation.hpp"

namespace modcal {

/// What is stated of a mode's frequency speaks for it where the data do not. deviation: of δ_n, the
/// first numbers.
void trust_stated_frequencies(const StatedPriors& priors, const Eigen::VectorXd& deviation,
                              std::vector<ModeVerdict>& modes);

}  // namespace modcal
