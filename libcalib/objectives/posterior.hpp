// An objective together with what is known beforehand.
#pragma once

#include "libcalib/problem.hpp"

namespace modcal {

/// `function` of these parameters, and what the section "parameters" of the problem states: r_j of
/// `function`, then L⁻¹(u − mean) of all that has a Gaussian prior with the covariance LLᵀ, u the
/// coordinates (ParameterType). These are the priors stated; those of every ζ_n, where each is
/// free; and ln f_n about the law by τ, where f_n and the law are free. value ½ ‖r‖² is minus the
/// logarithm of the posterior, save a constant. law_width: τ where the problem states none. A
/// schedule of stages is that of `function`.
std::unique_ptr<const ObjectiveFunction> with_priors(
    std::shared_ptr<const ObjectiveFunction> function, const Problem& problem,
    const ParameterSet& parameters, double law_width);

}  // namespace modcal
