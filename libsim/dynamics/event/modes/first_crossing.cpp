#include "libsim/dynamics/event/modes/first_crossing.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "libsim/dynamics/event/modes/tuning.hpp"

namespace modcal::event {
namespace {

// Fixed by: rounding of a double, 2.22e-16, and a little more.
constexpr double kRounding = 2.3e-16;

struct Jet {
  double value, slope, half_curvature;
};

Jet evaluate(std::span<const double> c, double t) {
  Jet jet{c.back(), 0.0, 0.0};
  for (std::size_t m = c.size() - 1; m-- > 0;) {
    jet.half_curvature = jet.half_curvature * t + jet.slope;
    jet.slope = jet.slope * t + jet.value;
    jet.value = jet.value * t + c[m];
  }
  return jet;
}

struct Bounds {
  double size = 0.0;   // Σ |c_m| upper^m
  double third = 0.0;  // ≥ |p'''| on [0, upper]
};

Bounds bounds_of(std::span<const double> c, double upper) {
  Bounds bounds;
  double power = 1.0, power_3 = 1.0;
  for (std::size_t m = 0; m < c.size(); ++m) {
    const double magnitude = std::abs(c[m]);
    bounds.size += magnitude * power;
    power *= upper;
    if (m >= 3) {
      bounds.third += static_cast<double>(m * (m - 1) * (m - 2)) * magnitude * power_3;
      power_3 *= upper;
    }
  }
  return bounds;
}

std::optional<double> march(std::span<const double> c, double upper) {
  const Bounds bounds = bounds_of(c, upper);
  double t = 0.0;
  for (int step = 0; step < kCrossingSteps; ++step) {
    const Jet jet = evaluate(c, t);
    if (!(jet.value > kRounding * bounds.size)) return t;
    const double curvature = 2.0 * jet.half_curvature - bounds.third * (upper - t);
    const double discriminant = jet.slope * jet.slope - 2.0 * curvature * jet.value;
    if (discriminant < 0.0) return std::nullopt;  // the parabola below p has no root at all
    const double denominator = -jet.slope + std::sqrt(discriminant);
    if (denominator <= 0.0) return std::nullopt;
    const double advance = 2.0 * jet.value / denominator;
    const double next = t + advance;
    if (next > upper) return std::nullopt;
    if (advance <= kRounding * next) return next;
    t = next;
  }
  return t;  // a contact so close to grazing that it counts as one
}

}  // namespace

std::optional<double> first_crossing(std::span<const double> coefficients, double upper,
                                     bool starts_at_zero) {
  assert(!coefficients.empty());
  if (starts_at_zero) {
    double largest = 0.0;
    for (const double c : coefficients.subspan(1)) largest = std::max(largest, std::abs(c));
    std::size_t skip = 1;
    while (skip + 1 < coefficients.size() && std::abs(coefficients[skip]) <= kVanishing * largest) {
      ++skip;
    }
    if (largest == 0.0) return std::nullopt;  // p is zero throughout: it never falls below
    coefficients = coefficients.subspan(skip);
    if (coefficients[0] < 0.0) return 0.0;
  }
  // Trailing coefficients below rounding cost time and change nothing.
  double size = 0.0;
  for (const double c : coefficients) size = std::max(size, std::abs(c));
  while (coefficients.size() > 4 && std::abs(coefficients.back()) <= 1e-18 * size) {
    coefficients = coefficients.first(coefficients.size() - 1);
  }
  return march(coefficients, upper);
}

}  // namespace modcal::event
