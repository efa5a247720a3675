#include "libsim/dynamics/gestures/sine_gesture.hpp"

#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"

namespace modcal {

void SineGesture::Options::visit(OptionVisitor& visitor) {
  visitor.number({.key = "mean", .meaning = "mean factor", .unit = "1"}, mean);
  visitor.number({.key = "amplitude", .meaning = "amplitude of the sine", .unit = "1"}, amplitude);
  visitor.number({.key = "frequency",
                  .meaning = "frequency of the sine",
                  .unit = "Hz",
                  .range = Range::positive()},
                 frequency);
  visitor.number({.key = "phase", .meaning = "phase at t = 0", .unit = "rad"}, phase);
}

PiecewiseLinear SineGesture::factor(double duration) const {
  constexpr double kPieces = 128.0;
  const double step = 1.0 / (kPieces * options_.frequency);
  const double count = std::ceil(duration / step);
  MODCAL_REQUIRE(count <= 1e7, "a gesture of {:g} Hz over {:g} s takes {:g} pieces: at most 1e7",
                 options_.frequency, duration, count);
  std::vector<double> times, values;
  for (std::size_t i = 0; i <= static_cast<std::size_t>(count); ++i) {
    const double periods = static_cast<double>(i) / kPieces;
    times.push_back(static_cast<double>(i) * step);
    values.push_back(options_.mean +
                     options_.amplitude *
                         std::sin(2.0 * std::numbers::pi * periods + options_.phase));
  }
  return {std::move(times), std::move(values)};
}

}  // namespace modcal
