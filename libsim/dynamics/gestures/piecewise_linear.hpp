// A piecewise-linear function of time: what every bow gesture reduces to.
#pragma once

#include <cstddef>
#include <vector>

namespace modcal {

/// g(t) through the knots (t_i [s], g_i), linear between them and constant outside. A value: cheap
/// queries, no virtual call. Throws InvalidInput unless the knots are finite and their times rise
/// strictly.
class PiecewiseLinear {
 public:
  /// The constant `value`: no knots.
  explicit PiecewiseLinear(double value = 0.0) : first_(value), last_(value) {}
  PiecewiseLinear(std::vector<double> times, std::vector<double> values);

  /// g(t).
  double at(double t) const;
  /// Right-hand derivative of g at t [1/s].
  double slope(double t) const;
  /// ∫ g dt from 0 to t [s], t ≥ 0.
  double integral(double t) const;
  /// First knot after t [s]; +∞ where there is none. Between two knots g is linear.
  double next_knot(double t) const;

  bool is_constant() const;
  double lowest() const;
  double highest() const;
  const std::vector<double>& times() const { return times_; }
  const std::vector<double>& values() const { return values_; }

  /// factor·g.
  PiecewiseLinear scaled(double factor) const;
  /// The function through the products g·h at the knots of both.
  PiecewiseLinear product(const PiecewiseLinear& other) const;

 private:
  // Number of knots at or before t: t lies after knot i − 1, before knot i.
  std::size_t knots_until(double t) const;
  double integral_from_first_knot(double t) const;

  std::vector<double> times_, values_;
  std::vector<double> area_;  // ∫ from the first knot to each knot
  double first_ = 0.0, last_ = 0.0;
};

}  // namespace modcal
