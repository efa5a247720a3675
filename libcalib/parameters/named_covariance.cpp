#include "libcalib/parameters/named_covariance.hpp"

#include <algorithm>
#include <cmath>

#include "libsim/base/dense_solvers.hpp"

namespace modcal {
namespace {

using Index = Eigen::Index;

}  // namespace

std::optional<std::size_t> NamedCovariance::find(std::string_view name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) return std::nullopt;
  return static_cast<std::size_t>(found - names.begin());
}

double NamedCovariance::deviation(std::size_t i) const {
  const auto at = static_cast<Index>(i);
  return std::sqrt(matrix(at, at));
}

std::vector<std::string> NamedCovariance::unknown() const {
  std::vector<std::string> result;
  for (std::size_t i = 0; i < size(); ++i) {
    if (std::isnan(deviation(i))) result.push_back(names[i]);
  }
  return result;
}

Eigen::MatrixXd NamedCovariance::correlations() const {
  const auto count = static_cast<Index>(size());
  Eigen::MatrixXd result = Eigen::MatrixXd::Identity(count, count);
  for (Index i = 0; i < count; ++i) {
    for (Index j = 0; j < i; ++j) {
      const double scale =
          deviation(static_cast<std::size_t>(i)) * deviation(static_cast<std::size_t>(j));
      if (scale == 0.0) continue;
      result(i, j) = result(j, i) = 0.5 * (matrix(i, j) + matrix(j, i)) / scale;
    }
  }
  return result;
}

std::vector<double> NamedCovariance::singular_values() const {
  const Eigen::MatrixXd scaled = correlations();
  std::vector<double> values;
  if (scaled.size() == 0) return values;
  // Ascending: the best-known combination first. What rounding leaves below 0 is 0.
  const Eigen::VectorXd variances = symmetric_eigenvalues(scaled);
  for (const double variance : variances) {
    values.push_back(variance > 0.0 ? 1.0 / std::sqrt(variance)
                                    : std::numeric_limits<double>::infinity());
  }
  return values;
}

double NamedCovariance::condition() const {
  const std::vector<double> values = singular_values();
  return values.empty() ? 1.0 : values.front() / values.back();
}

void NamedCovariance::raise(std::string_view name, double deviation) {
  const std::optional<std::size_t> found = find(name);
  if (!found) return;
  const auto i = static_cast<Index>(*found);
  matrix(i, i) = std::max(matrix(i, i), deviation * deviation);
}

std::vector<CorrelatedPair> strongest_correlations(const NamedCovariance& covariance,
                                                   const std::vector<bool>& taken,
                                                   std::size_t count) {
  const Eigen::MatrixXd correlations = covariance.correlations();
  std::vector<CorrelatedPair> pairs;
  for (std::size_t i = 0; i < covariance.size(); ++i) {
    for (std::size_t j = 0; taken[i] && j < i; ++j) {
      if (!taken[j]) continue;
      pairs.push_back({j, i, correlations(static_cast<Index>(i), static_cast<Index>(j))});
    }
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const CorrelatedPair& a, const CorrelatedPair& b) {
                     return std::abs(a.correlation) > std::abs(b.correlation);
                   });
  pairs.resize(std::min(count, pairs.size()));
  return pairs;
}

}  // namespace modcal
