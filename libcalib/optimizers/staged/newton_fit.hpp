// Damped Newton steps on the joint likelihood with the information freed of its noise.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <limits>
#include <span>

#include "libcalib/likelihood/newton_step.hpp"
#include "libcalib/likelihood/projected_likelihood.hpp"
#include "libcalib/parameters/string_unknowns.hpp"
#include "libcalib/problem/evaluator.hpp"

namespace modcal {

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

}  // namespace modcal
