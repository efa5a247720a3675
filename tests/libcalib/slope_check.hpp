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

}  // namespace modcal
