// Sparse amplitudes by automatic relevance determination.
#pragma once

#include <Eigen/Core>
#include <iterator>
#include <vector>

namespace modcal {

/// Posterior of amplitudes p_j ~ N(0, a_j) under the likelihood exp(bᵀp − pᵀAp/2).
struct Relevance {
  Eigen::VectorXd widths;            ///< a_j
  std::vector<Eigen::Index> chosen;  ///< those above 1e-6 of the largest: the other p_j are 0
  Eigen::VectorXd mean;
  Eigen::MatrixXd root;   ///< R of the covariance RᵀR of the chosen
  double evidence = 0.0;  ///< ln of it, over that of p = 0; −∞: lost in rounding

  bool are_few() const { return 2 * std::ssize(chosen) < mean.size(); }
};

/// The a_j of largest evidence: a_j ← μ_j²/γ_j, γ_j = 1 − C_jj/a_j (MacKay, 1992; Tipping, 2001).
/// Those below 1e-6 of the largest stay there. Which k of all N are chosen was found from the data,
/// too, and any k as likely before: ln N!/(k! (N − k)!) is taken off the evidence. Where half of
/// all are left after ten sweeps these are not few: the search ends.
Relevance determine_relevance(const Eigen::MatrixXd& a, const Eigen::VectorXd& b);

/// The same with the widths given.
Relevance posterior_of(const Eigen::MatrixXd& a, const Eigen::VectorXd& b,
                       const Eigen::VectorXd& widths);

/// Largest posterior density of p ≥ 0 (active set of Lawson and Hanson, 1974).
Eigen::VectorXd non_negative_mean(const Eigen::MatrixXd& a, const Eigen::VectorXd& b,
                                  const Eigen::VectorXd& widths);

}  // namespace modcal
