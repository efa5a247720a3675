// Damped Newton steps on the joint likelihood with the information freed of its noise.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <span>

#include "libcalib/likelihood/projected_likelihood.hpp"
#include "libcalib/parameters/string_unknowns.hpp"
#include "libcalib/problem/evaluator.hpp"

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

/// What a fit evaluates.
struct FitTarget {
  std::function<LikelihoodPoint(const Eigen::VectorXd&)> evaluate;
  std::function<bool(const Eigen::VectorXd&)> admits;
  Eigen::Index capped = 0;  ///< leading unknowns that frequency_cap holds
  /// Cost and slope alone; empty: evaluate.
  std::function<LikelihoodPoint(const Eigen::VectorXd&)> slope = {};
  /// Cost, slope and, as its rows, those of the information of some unknowns, or all of it; empty:
  /// evaluate.
  std::function<LikelihoodPoint(const Eigen::VectorXd&, std::span<const std::size_t> wanted)> rows =
      {};
  Eigen::VectorXd lower = {}, upper = {};  ///< bounds of the unknowns; empty: none
};

struct NewtonFit {
  Eigen::VectorXd theta;
  double objective = std::numeric_limits<double>::infinity();  ///< Σ w|e|² + ½ (θ − θ_0)ᵀQ(θ − θ_0)
  LikelihoodPoint point;  ///< rows of its information may be those of points before
  std::size_t evaluations = 0;
  std::size_t slopes = 0;   ///< those of cost and slope alone
  std::size_t partial = 0;  ///< those of some rows of the information
  bool converged = false;
};

/// Minimizes Σ w|e|² + ½ (θ − θ_0)ᵀQ(θ − θ_0) from `start` by Scoring, Hessian 2(JᵀWJ − N̄) + Q,
/// within the search of `within`; null: a search of its own.
NewtonFit newton_fit(const FitTarget& target, const Eigen::VectorXd& start,
                     const NewtonOptions& options, Evaluator* within = nullptr);
/// The same for one record.
NewtonFit newton_fit(const ProjectedLikelihood& likelihood, const StringUnknowns& unknowns,
                     const Eigen::VectorXd& start, const NewtonOptions& options);
FitTarget fit_target(const ProjectedLikelihood& likelihood, const StringUnknowns& unknowns);

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
