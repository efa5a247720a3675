#include "libinverse/structure/strikes/pole_scatter.hpp"

#include <algorithm>
#include <cmath>
#include <unsupported/Eigen/SpecialFunctions>
#include <vector>

#include "libsim/base/error.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

// Where a function that falls over positive numbers has this value; `least` or `most` beyond its
// ends.
template <typename Function>
double falls_to(double value, double least, double most, Function&& function) {
  if (function(least) <= value) return least;
  if (function(most) >= value) return most;
  double low = std::log(least), high = std::log(most);
  for (int step = 0; step < 80; ++step) {
    const double middle = 0.5 * (low + high);
    (function(std::exp(middle)) > value ? low : high) = middle;
  }
  return std::exp(0.5 * (low + high));
}

double median_of(const Eigen::ArrayXd& values) {
  return quantile({values.begin(), values.end()}, 0.5);
}

// Median of χ²/d (Wilson and Hilferty, 1931): for d = 1 by 3 % too large, else by less than 1 %.
double median_of_variance(double degrees) { return std::pow(1.0 - 2.0 / (9.0 * degrees), 3.0); }

// By how much variances over v scatter beside χ²/d: about s₀², as χ² of ν degrees does.
struct Common {
  double degrees;   // ν
  double variance;  // s₀²
};

Common common_of(const Eigen::ArrayXd& ratios, double degrees) {
  using Eigen::numext::digamma, Eigen::numext::polygamma;
  const auto modes = static_cast<double>(ratios.size());
  // All modes together tell no more than their own degrees.
  if (ratios.size() < 2) return {.degrees = 0.0, .variance = 1.0};
  const double most = degrees * (modes - 1.0);
  const Eigen::ArrayXd e =
      ratios.max(1e-12).log() - digamma(0.5 * degrees) + std::log(0.5 * degrees);
  const double beyond =
      (e - e.mean()).square().sum() / (modes - 1.0) - polygamma(1.0, 0.5 * degrees);
  const double half =
      falls_to(beyond, 1e-3, 0.5 * most, [](double y) { return polygamma(1.0, y); });
  return {.degrees = 2.0 * half, .variance = std::exp(e.mean() + digamma(half) - std::log(half))};
}

}  // namespace

FurtherStrike further_strike(const Eigen::MatrixXd& values, const Eigen::VectorXd& told,
                             const Eigen::VectorXd& common) {
  MODCAL_REQUIRE(values.rows() >= 2 && values.cols() == told.size() &&
                     common.size() == told.size() && told.size() > 0,
                 "a scatter needs 2 strikes and a deviation for each of {} modes, here {} and {}",
                 values.cols(), values.rows(), told.size());
  const auto strikes = static_cast<double>(values.rows());
  const double degrees = strikes - 1.0;
  const Eigen::RowVectorXd mean = values.colwise().mean();
  Eigen::MatrixXd departures = values.rowwise() - mean;
  const Eigen::VectorXd scatters = (departures.colwise().squaredNorm() / degrees).cwiseSqrt();
  double alike = 0.0;
  if (told.size() > 1) {
    for (Eigen::Index i = 0; i < values.rows(); ++i) {
      const double shift = median_of(departures.row(i));
      departures.row(i).array() -= shift;
      alike += shift * shift / degrees;
    }
    departures.rowwise() -= departures.colwise().mean().eval();
  }
  const Eigen::ArrayXd variances = departures.colwise().squaredNorm().transpose() / degrees;
  const Eigen::ArrayXd own = strikes * told.array().square() + 1e-300;
  const double largest = variances.maxCoeff() + 1e-300;
  const double shared = falls_to(median_of_variance(degrees), 1e-12 * largest, 1e3 * largest,
                                 [&](double tau) { return median_of(variances / (own + tau)); });
  const Eigen::ArrayXd expected = own + shared, ratios = variances / expected;
  const auto [prior, scale] = common_of(ratios, degrees);
  const double all = prior + degrees;
  const Eigen::ArrayXd moderated = expected * (prior * scale + degrees * ratios) / all;
  const auto widened = [](double counted) {
    const double wide = student_quantile(static_cast<std::size_t>(counted)) / student_quantile(0);
    return wide * wide;
  };
  const Eigen::ArrayXd further =
      (1.0 + 1.0 / strikes) * (widened(degrees) * alike + widened(all) * moderated) +
      (common.transpose() - mean).transpose().array().square();
  return {.deviations = further.sqrt(), .scatters = scatters};
}

std::vector<std::vector<ModalPole>> poles_of_each(const std::vector<SearchedStrike>& strikes,
                                                  const std::vector<SensorKind>& kinds,
                                                  const std::vector<ModalPole>& all) {
  std::vector<std::vector<ModalPole>> each(strikes.size(), all);
  for (std::size_t i = 0; i < strikes.size(); ++i) {
    PoleSearch(std::span(strikes).subspan(i, 1), kinds).fit(each[i], 30);
  }
  return each;
}

FurtherStrike further_strike(const std::vector<std::vector<ModalPole>>& each,
                             const std::vector<ModalPole>& all, double ModalPole::*quantity,
                             const std::vector<double>& told) {
  const auto logarithms = [quantity](const std::vector<ModalPole>& poles) {
    Eigen::VectorXd result(std::ssize(poles));
    std::ranges::transform(poles, result.begin(),
                           [quantity](const ModalPole& pole) { return std::log(pole.*quantity); });
    return result;
  };
  Eigen::MatrixXd values(std::ssize(each), std::ssize(all));
  for (std::size_t i = 0; i < each.size(); ++i) {
    values.row(static_cast<Eigen::Index>(i)) = logarithms(each[i]);
  }
  return further_strike(values, Eigen::Map<const Eigen::VectorXd>(told.data(), std::ssize(told)),
                        logarithms(all));
}

}  // namespace modcal
