// Gradients and Jacobians against central differences.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "libcalib/problem/objective_function.hpp"
#include "libcalib/problem/variable.hpp"

namespace modcal {

/// Compares gradient and, where there is one, Jacobian at x with differences over ±step·scale of
/// every variable. The differences are wrong by step² times a third derivative and by rounding over
/// the step; `tolerance` is relative to the largest slope of the variable.
inline void expect_slopes_match(const ObjectiveFunction& function,
                                const std::vector<Variable>& variables,
                                const std::vector<double>& x, double step, double tolerance) {
  const std::size_t n = function.dimension();
  const std::size_t m = function.residual_count();
  std::vector<double> gradient(n), residuals(m), jacobian(m * n), high(m), low(m);
  function.evaluate(x, {.gradient = gradient.data(),
                        .residuals = m ? residuals.data() : nullptr,
                        .jacobian = m ? jacobian.data() : nullptr});
  for (std::size_t i = 0; i < n; ++i) {
    const double h = step * variables[i].scale;
    std::vector<double> above = x, below = x;
    above[i] += h;
    below[i] -= h;
    double value_above = 0.0, value_below = 0.0;
    function.evaluate(above, {.value = &value_above, .residuals = m ? high.data() : nullptr});
    function.evaluate(below, {.value = &value_below, .residuals = m ? low.data() : nullptr});
    const double slope = (value_above - value_below) / (2.0 * h);
    EXPECT_NEAR(gradient[i], slope, tolerance * std::abs(slope)) << variables[i].name;
    EXPECT_NE(gradient[i], 0.0) << variables[i].name;
    double error = 0.0, size = 0.0;
    for (std::size_t j = 0; j < m; ++j) {
      error = std::max(error, std::abs(jacobian[j * n + i] - (high[j] - low[j]) / (2.0 * h)));
      size = std::max(size, std::abs(jacobian[j * n + i]));
    }
    EXPECT_LE(error, tolerance * size) << variables[i].name;
  }
}

/// How gradient, Jacobian and residuals agree in one variable.
struct LeastSquaresSlope {
  double gradient = 0.0;
  double own = 0.0;       ///< Jᵀr
  double quotient = 0.0;  ///< of values a hundredth of a standard deviation off, all else known
  double scale = 0.0;     ///< √(JᵀJ): the slope of one standard deviation
};

inline std::vector<LeastSquaresSlope> least_squares_slopes(const ObjectiveFunction& function,
                                                           const std::vector<double>& x) {
  const std::size_t n = x.size(), m = function.residual_count();
  std::vector<double> gradient(n), residuals(m), jacobian(m * n);
  function.evaluate(
      x, {.gradient = gradient.data(), .residuals = residuals.data(), .jacobian = jacobian.data()});
  std::vector<LeastSquaresSlope> slopes(n);
  for (std::size_t i = 0; i < n; ++i) {
    LeastSquaresSlope& slope = slopes[i];
    slope.gradient = gradient[i];
    for (std::size_t j = 0; j < m; ++j) {
      slope.own += jacobian[j * n + i] * residuals[j];
      slope.scale += jacobian[j * n + i] * jacobian[j * n + i];
    }
    slope.scale = std::sqrt(slope.scale);
    EXPECT_GT(slope.scale, 0.0);
    std::vector<double> above = x, below = x;
    above[i] += 1e-2 / slope.scale;
    below[i] -= 1e-2 / slope.scale;
    slope.quotient = (function.value(above) - function.value(below)) * slope.scale / 2e-2;
  }
  return slopes;
}

}  // namespace modcal
