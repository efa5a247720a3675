#include "libcalib/identifiability/model_posterior.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace modcal {
namespace {

// L with L Lᵀ = C. Cholesky's, without pivots: eigenvectors of equal eigenvalues, and pivots of
// equal size, are another ones by another rounding.
Eigen::MatrixXd root_of(const Eigen::MatrixXd& covariance) {
  // Units differ by many orders: of correlations. What is held has none.
  const Eigen::VectorXd deviation = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd inverse =
      deviation.unaryExpr([](double x) { return x > 0.0 ? 1.0 / x : 0.0; });
  Eigen::MatrixXd correlation = inverse.asDiagonal() * covariance * inverse.asDiagonal();
  // Where two unknowns are told only together, rounding may leave no root: 1e-12 of the variances
  // and more, until it does.
  Eigen::LLT<Eigen::MatrixXd> root;
  for (int digits = 12; digits > 0; --digits) {
    correlation.diagonal().setConstant(1.0 + std::pow(10.0, -digits));
    if (root.compute(correlation).info() == Eigen::Success) break;
  }
  return deviation.asDiagonal() * Eigen::MatrixXd(root.matrixL());
}

}  // namespace

std::vector<ModelPoint> ModelPosterior::draw(std::size_t count, const StreamKey& key) const {
  std::vector<ModelPoint> models;
  if (theta.size() == 0) return models;
  const Eigen::MatrixXd root = root_of(covariance);
  Eigen::VectorXd z(theta.size());
  for (std::size_t i = 0; i < 10 * count && models.size() < count; ++i) {  // where most can be
    fill_standard_normal(key.with(std::uint64_t{i}),
                         {z.data(), static_cast<std::size_t>(z.size())});
    const Eigen::VectorXd drawn = theta + root * z;
    if (unknowns.admits(drawn)) models.push_back(unknowns.model(drawn));
  }
  return models;
}

}  // namespace modcal
