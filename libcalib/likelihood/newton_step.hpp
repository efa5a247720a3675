// One Newton step on the joint likelihood with the information freed of its noise, and what it says
// of the fit that it ends.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>

#include "libcalib/likelihood/likelihood_outputs.hpp"
#include "libcalib/parameters/prior_equations.hpp"

namespace modcal {

struct NewtonOptions {
  std::size_t steps = 15;
  /// Ends when gᵀH⁻¹g is below this: the step is then below its root in standard deviations.
  double tolerance = 1e-4;
  double frequency_cap = std::numeric_limits<double>::infinity();  ///< of one δ_n in one step
  Eigen::MatrixXd noise;       ///< N̄; empty: none is subtracted
  Eigen::MatrixXd prior;       ///< precision Q; empty: none
  Eigen::VectorXd prior_mean;  ///< θ_0; empty: 0
  /// What the target gives at the start, where that is known; null: it is evaluated.
  const LikelihoodPoint* at_start = nullptr;
};

/// Q with zeros for the unknowns that have no prior, the last ones.
Eigen::MatrixXd padded_prior(const Eigen::MatrixXd& prior, Eigen::Index size);

/// Hessian of a likelihood's value by its information I, freed of its noise: I − N̄ + Q, N̄ shrunk by
/// 0.9 as often as it takes to leave I − N̄ + 0.9 Q positive definite: no direction comes out much
/// worse known than the prior Q has it. Empty N̄ or Q: none; a Q of fewer rows is one of the first.
Eigen::MatrixXd debiased_hessian(const Eigen::MatrixXd& information, const Eigen::MatrixXd& noise,
                                 const Eigen::MatrixXd& prior);

/// What is stated of the unknowns with the law's scatter, and the same with a scatter so wide that
/// the data alone say where a mode is.
struct LawStatements {
  PriorEquations law, wide;
};
/// The law by one step from a point with `twice_weighted` at θ. more: covariance M of further
/// errors of a fit with the priors among the options, of Hessian H, whose scores have so C = H M H.
/// With the Hessian A under the wide statements and Q beyond them,
///
///     (P A + Q) Δθ = −(P ∇_wide + ∇_law − ∇_wide),   P = A (A + C)⁻¹:
///
/// a mode that such an error moves tells less of the law. C = 0: the step under the law's
/// statements.
LawPosterior law_of_step(const LawStatements& statements, const LikelihoodPoint& at,
                         const Eigen::VectorXd& theta, NewtonOptions options,
                         const Eigen::MatrixXd& more);

/// How much less than at the truth Σ|e|² without weights is expected where a fit with weights ends,
/// in residuals: 4 tr H⁻¹JᵀWJ − 2 tr (JᵀJ) Cov, of a fit without weights and priors the number of
/// its unknowns. An unknown that its prior holds takes none; one that the weights leave to its
/// prior, while noise alone curves the cost, gives some back. whole: JᵀJ without weights.
double taken_by_fit(const LikelihoodPoint& point, const NewtonOptions& options,
                    const Eigen::MatrixXd& whole);

/// H⁻¹B for a matrix B of as many rows.
Eigen::MatrixXd fit_response(const LikelihoodPoint& point, const NewtonOptions& options,
                             const Eigen::MatrixXd& change);

/// H⁻¹(2 JᵀW²J + Q)H⁻¹ of the fit's last point, which must hold `twice_weighted`.
Eigen::MatrixXd fit_covariance(const LikelihoodPoint& point, const NewtonOptions& options);

}  // namespace modcal
