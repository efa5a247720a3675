#include "libsim/dynamics/gestures/gesture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "libsim/base/random.hpp"
#include "libsim/dynamics/gestures/tuning.hpp"

namespace modcal {

namespace {

double sinc(double x) {
  const double angle = std::numbers::pi * x;
  return x == 0.0 ? 1.0 : std::sin(angle) / angle;
}

double lanczos(double x) {
  return std::abs(x) < kNoiseLobes ? sinc(x) * sinc(x / static_cast<double>(kNoiseLobes)) : 0.0;
}

}  // namespace

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

PiecewiseLinear Gesture::over(double duration) const {
  MODCAL_REQUIRE(duration > 0.0 && std::isfinite(duration),
                 "a gesture over {:g} s: the duration must be > 0", duration);
  return factor(duration);
}

Registry<Gesture> Gesture::registry() {
  static constexpr std::array kTable = {
      entry_of<Gesture, RampGesture>("ramp", "linear change from one factor to another"),
      entry_of<Gesture, SineGesture>("sine", "sinusoidal change about a mean"),
      entry_of<Gesture, SteadyGesture>("steady", "no change"),
      entry_of<Gesture, TableGesture>("table", "straight lines through points in time"),
  };
  return kTable;
}

void TableGesture::Options::visit(OptionVisitor& visitor) {
  visitor("times", "times of the points, strictly rising", {.unit = "s", .required = true}, times);
  visitor("factors", "factors at these times", {.required = true}, factors);
}

void RampGesture::Options::visit(OptionVisitor& visitor) {
  visitor("from", "factor before the ramp", from);
  visitor("to", "factor after the ramp", to);
  visitor("start", "time at which the ramp starts", {.unit = "s", .range = Range::non_negative()},
          start);
  visitor("duration", "length of the ramp", {.unit = "s", .range = Range::positive()}, duration);
}

PiecewiseLinear RampGesture::factor(double /*duration*/) const {
  return {{options_.start, options_.start + options_.duration}, {options_.from, options_.to}};
}

void SineGesture::Options::visit(OptionVisitor& visitor) {
  visitor("mean", "mean factor", mean);
  visitor("amplitude", "amplitude of the sine", amplitude);
  visitor("frequency", "frequency of the sine", {.unit = "Hz", .range = Range::positive()},
          frequency);
  visitor("phase", "phase at t = 0", {.unit = "rad"}, phase);
}

PiecewiseLinear SineGesture::factor(double duration) const {
  const double step = 1.0 / (kPiecesPerPeriod * options_.frequency);
  const double count = std::ceil(duration / step);
  MODCAL_REQUIRE(count <= 1e7, "a gesture of {:g} Hz over {:g} s takes {:g} pieces: at most 1e7",
                 options_.frequency, duration, count);
  std::vector<double> times, values;
  for (std::size_t i = 0; i <= static_cast<std::size_t>(count); ++i) {
    const double periods = static_cast<double>(i) / kPiecesPerPeriod;
    times.push_back(static_cast<double>(i) * step);
    values.push_back(options_.mean +
                     options_.amplitude *
                         std::sin(2.0 * std::numbers::pi * periods + options_.phase));
  }
  return {std::move(times), std::move(values)};
}

void GestureNoise::visit(OptionVisitor& visitor) {
  visitor("level", "standard deviation over the nominal value", {.range = Range::non_negative()},
          level);
  visitor("cutoff", "frequency above which there is no noise",
          {.unit = "Hz", .range = Range::positive()}, cutoff);
  visitor("seed", "seed of the draws", {.range = Range::non_negative()}, seed);
}

PiecewiseLinear GestureNoise::factor(double duration, std::string_view role) const {
  if (!present || level == 0.0) return PiecewiseLinear(1.0);
  const double pieces = std::ceil(duration * 2.0 * cutoff * static_cast<double>(kNoisePieces));
  MODCAL_REQUIRE(pieces <= 1e7, "noise up to {:g} Hz over {:g} s takes {:g} pieces: at most 1e7",
                 cutoff, duration, pieces);
  const auto count = static_cast<std::size_t>(pieces) + 1;
  std::vector<double> draws((count - 1) / kNoisePieces + 2 * kNoiseLobes + 1);
  fill_standard_normal(StreamKey(static_cast<std::uint64_t>(seed)).with(role), draws);
  std::vector<double> times(count), values(count, 1.0);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t whole = i / kNoisePieces;
    const double part = static_cast<double>(i % kNoisePieces) / static_cast<double>(kNoisePieces);
    times[i] = static_cast<double>(i) / (2.0 * cutoff * static_cast<double>(kNoisePieces));
    // Draw j stands at the time (j − kNoiseLobes)/(2 f_cut).
    for (std::size_t j = 0; j <= 2 * kNoiseLobes; ++j) {
      const double distance = part + static_cast<double>(kNoiseLobes) - static_cast<double>(j);
      values[i] += level * draws[whole + j] * lanczos(distance);
    }
  }
  return {std::move(times), std::move(values)};
}

}  // namespace modcal
