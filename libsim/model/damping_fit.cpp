#include "libsim/model/damping_fit.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <set>

#include "libsim/base/error.hpp"

namespace modcal {

double DampingFit::ratio(std::size_t n) const {
  double value = 0.0;
  for (std::size_t j = coefficients.size(); j-- > 0;) {
    value = value * static_cast<double>(n) + coefficients[j];
  }
  return value;
}

DampingFit fit_damping(std::span<const std::size_t> mode_numbers, std::span<const double> ratios,
                       std::size_t degree) {
  MODCAL_REQUIRE(mode_numbers.size() == ratios.size(), "{} mode numbers and {} damping ratios",
                 mode_numbers.size(), ratios.size());
  const std::set<std::size_t> distinct(mode_numbers.begin(), mode_numbers.end());
  MODCAL_REQUIRE(distinct.size() == mode_numbers.size(), "a mode is listed twice");
  MODCAL_REQUIRE(distinct.size() > degree,
                 "a polynomial of degree {} needs at least {} modes; {} are given", degree,
                 degree + 1, distinct.size());
  MODCAL_REQUIRE(*distinct.begin() >= 1, "modes are numbered from 1");
  // Columns (n/top)^j: of comparable size, so that QR sees the condition of the abscissae alone.
  const double top = static_cast<double>(*distinct.rbegin());
  const auto rows = static_cast<Eigen::Index>(ratios.size());
  const auto columns = static_cast<Eigen::Index>(degree + 1);
  Eigen::MatrixXd matrix(rows, columns);
  Eigen::VectorXd right(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const auto index = static_cast<std::size_t>(i);
    MODCAL_REQUIRE(std::isfinite(ratios[index]), "damping ratio {:g} of mode {} is not finite",
                   ratios[index], mode_numbers[index]);
    right[i] = ratios[index];
    const double abscissa = static_cast<double>(mode_numbers[index]) / top;
    matrix(i, 0) = 1.0;
    for (Eigen::Index j = 1; j < columns; ++j) matrix(i, j) = matrix(i, j - 1) * abscissa;
  }
  const Eigen::VectorXd solution = matrix.householderQr().solve(right);
  DampingFit fit;
  double power = 1.0;
  for (const double value : solution) {
    fit.coefficients.push_back(value / power);
    power *= top;
  }
  fit.rms_residual =
      std::sqrt((matrix * solution - right).squaredNorm() / static_cast<double>(rows));
  return fit;
}

}  // namespace modcal
