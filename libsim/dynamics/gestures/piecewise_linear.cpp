#include "libsim/dynamics/gestures/piecewise_linear.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libsim/base/error.hpp"

namespace modcal {

PiecewiseLinear::PiecewiseLinear(std::vector<double> times, std::vector<double> values)
    : times_(std::move(times)), values_(std::move(values)) {
  MODCAL_REQUIRE(times_.size() == values_.size(),
                 "{} times and {} values were given: each time needs one value", times_.size(),
                 values_.size());
  MODCAL_REQUIRE(!times_.empty(), "a function of time needs at least one knot");
  area_.resize(times_.size(), 0.0);
  for (std::size_t i = 0; i < times_.size(); ++i) {
    MODCAL_REQUIRE(std::isfinite(times_[i]) && std::isfinite(values_[i]),
                   "knot {} ({:g} s, {:g}) is not finite", i + 1, times_[i], values_[i]);
    if (i == 0) continue;
    const double step = times_[i] - times_[i - 1];
    MODCAL_REQUIRE(step > 0.0,
                   "the times must rise strictly, but {:g} s follows {:g} s; write a jump as a "
                   "short ramp",
                   times_[i], times_[i - 1]);
    area_[i] = area_[i - 1] + 0.5 * step * (values_[i] + values_[i - 1]);
  }
  first_ = values_.front();
  last_ = values_.back();
}

std::size_t PiecewiseLinear::knots_until(double t) const {
  return static_cast<std::size_t>(std::upper_bound(times_.begin(), times_.end(), t) -
                                  times_.begin());
}

double PiecewiseLinear::at(double t) const {
  const std::size_t i = knots_until(t);
  if (i == 0) return first_;
  if (i == times_.size()) return last_;
  const double share = (t - times_[i - 1]) / (times_[i] - times_[i - 1]);
  return values_[i - 1] + share * (values_[i] - values_[i - 1]);
}

double PiecewiseLinear::slope(double t) const {
  const std::size_t i = knots_until(t);
  if (i == 0 || i == times_.size()) return 0.0;
  return (values_[i] - values_[i - 1]) / (times_[i] - times_[i - 1]);
}

double PiecewiseLinear::integral_from_first_knot(double t) const {
  if (times_.empty()) return first_ * t;
  const std::size_t i = knots_until(t);
  if (i == 0) return first_ * (t - times_.front());
  return area_[i - 1] + 0.5 * (t - times_[i - 1]) * (values_[i - 1] + at(t));
}

double PiecewiseLinear::integral(double t) const {
  return integral_from_first_knot(t) - integral_from_first_knot(0.0);
}

double PiecewiseLinear::next_knot(double t) const {
  const std::size_t i = knots_until(t);
  return i < times_.size() ? times_[i] : std::numeric_limits<double>::infinity();
}

bool PiecewiseLinear::is_constant() const { return lowest() == highest(); }

double PiecewiseLinear::lowest() const {
  return values_.empty() ? first_ : *std::min_element(values_.begin(), values_.end());
}

double PiecewiseLinear::highest() const {
  return values_.empty() ? first_ : *std::max_element(values_.begin(), values_.end());
}

PiecewiseLinear PiecewiseLinear::scaled(double factor) const {
  if (times_.empty()) return PiecewiseLinear(factor * first_);
  std::vector<double> values = values_;
  for (double& value : values) value *= factor;
  return {times_, std::move(values)};
}

PiecewiseLinear PiecewiseLinear::product(const PiecewiseLinear& other) const {
  if (other.times_.empty()) return scaled(other.first_);
  if (times_.empty()) return other.scaled(first_);
  std::vector<double> knots = times_;
  knots.insert(knots.end(), other.times_.begin(), other.times_.end());
  std::sort(knots.begin(), knots.end());
  knots.erase(std::unique(knots.begin(), knots.end()), knots.end());
  std::vector<double> values;
  for (const double t : knots) values.push_back(at(t) * other.at(t));
  return {std::move(knots), std::move(values)};
}

}  // namespace modcal
