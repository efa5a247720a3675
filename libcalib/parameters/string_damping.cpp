// The damping ratios as the unknowns have them.
#include <cmath>

#include "libcalib/parameters/string_unknowns.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;
using Kind = ParameterKind;

}  // namespace

double StringUnknowns::mean_damping_change(const ModelPoint& from, const ModelPoint& to) const {
  double change = 0.0, count = 0.0;
  for (std::size_t n = 0; n < modes(); ++n) {
    if (priors_.fixes_ratio(n)) continue;
    change += std::log(to.basis.zeta[n] / from.basis.zeta[n]);
    count += 1.0;
  }
  return change / std::max(count, 1.0);
}

// ln ζ_n/ζ_n(reference).
double StringUnknowns::damping_change(std::size_t mode, const Eigen::VectorXd& theta) const {
  double change = 0.0;
  for (const std::size_t i : free_.movers(Moves::kDamping, mode)) {
    change += free_.share(i, mode, 0.0) * theta[static_cast<Index>(i)];
  }
  return change;
}

double StringUnknowns::damping_factor(const Eigen::VectorXd& theta) const {
  if (free_.has(Kind::kDampingPower)) return std::exp(theta[damping()]);
  double sum = 0.0, count = 0.0;
  for (std::size_t n = 0; n < modes(); ++n) {
    sum += damping_change(n, theta);
    count += priors_.fixes_ratio(n) ? 0.0 : 1.0;
  }
  return std::exp(sum / std::max(count, 1.0));
}

double StringUnknowns::damping_power(const Eigen::VectorXd& theta) const {
  return free_.has(Kind::kDampingPower) ? theta[damping() + 1] : 0.0;
}

double StringUnknowns::damping_power_deviation(const Eigen::MatrixXd& covariance) const {
  if (!free_.has(Kind::kDampingPower)) return 0.0;
  return std::sqrt(covariance(damping() + 1, damping() + 1));
}

std::vector<double> StringUnknowns::ratio_deviations(const Eigen::MatrixXd& covariance) const {
  std::vector<double> result;
  for (Index i = damping(); free_.has(Kind::kDampingRatio) && i < damping() + damping_count_; ++i) {
    result.push_back(held(i) ? 0.0 : std::sqrt(covariance(i, i)));
  }
  return result;
}

double StringUnknowns::damping_deviation(const Eigen::MatrixXd& covariance) const {
  const Index count = damping_count();
  if (count == 0) return 0.0;
  // The mean of all changes is linear in the unknowns.
  Eigen::VectorXd slope(count);
  for (Index i = 0; i < count; ++i) {
    Eigen::VectorXd theta = Eigen::VectorXd::Zero(size());
    theta[damping() + i] = 1.0;
    slope[i] = std::log(damping_factor(theta));
  }
  return std::sqrt(slope.dot(covariance.block(damping(), damping(), count, count) * slope));
}

}  // namespace modcal
