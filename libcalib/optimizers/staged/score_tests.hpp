// Score tests: what a fit leaves against causes that its model has not.
#pragma once

#include <vector>

#include "libcalib/identifiability/misfit_causes.hpp"
#include "libcalib/optimizers/staged/newton_fit.hpp"

namespace modcal {

/// Tests every cause at θ, where the fit has ended; of those of one name the one found best:
///
///     S = bᵀA⁻¹b,  b = g_p − KᵀG,  K = H⁻¹ 2JᵀWJ_p,  A = 2J_pᵀWJ_p − 2J_pᵀWJ K
///
/// with the gradient G and Hessian H of the unknowns, J_p and g_p those of the cause's amplitudes p
/// (Rao, 1948). W ≤ 1 makes A too large: S is no more than χ² of so many degrees. deviation: of the
/// unknowns; misfit: the reduced χ², which S is divided by where it is above 1.
std::vector<ScoreTest> score_tests(const ProjectedLikelihood& likelihood,
                                   const StringUnknowns& unknowns, const Eigen::VectorXd& theta,
                                   const NewtonOptions& options, const Eigen::VectorXd& deviation,
                                   double misfit);

}  // namespace modcal
