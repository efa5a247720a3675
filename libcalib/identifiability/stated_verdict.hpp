// What priors say of the modes.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "libcalib/optimizers/staged/continuation.hpp"

namespace modcal {

/// What is stated of a mode's frequency speaks for it where the data do not, or where it is held.
/// deviation: of δ_n, the first numbers; empty where frequencies follow the law.
void trust_stated_frequencies(const StatedPriors& priors, const Eigen::VectorXd& deviation,
                              std::vector<ModeVerdict>& modes);

/// A frequency that is held or has a prior scatters about the law as those do that the data see.
void widen_stated(const StatedPriors& priors, double width, Eigen::VectorXd& widths);

}  // namespace modcal
