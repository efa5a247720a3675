// Gauss–Legendre quadrature on [0, 1].
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

namespace modcal::event {

struct GaussRule {
  std::vector<double> node, weight;
};

/// n points, exact for polynomials of degree 2n − 1: the roots of P_n by Newton's method from
/// cos(π (i + ¾)/(n + ½)) (Abramowitz and Stegun, 1964, 25.4.30).
inline GaussRule gauss_rule(int points) {
  GaussRule rule;
  for (int i = 0; i < points; ++i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (points + 0.5)), slope = 1.0;
    for (int iteration = 0; iteration < 8; ++iteration) {
      double p = 1.0, before = 0.0;
      for (int k = 1; k <= points; ++k) {
        const double next = ((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k;
        before = p;
        p = next;
      }
      slope = points * (x * p - before) / (x * x - 1.0);
      x -= p / slope;
    }
    rule.node.push_back(0.5 * (1.0 - x));
    rule.weight.push_back(1.0 / ((1.0 - x * x) * slope * slope));
  }
  return rule;
}

}  // namespace modcal::event
