#include "libsim/dynamics/gestures/ramp_gesture.hpp"

namespace modcal {

void RampGesture::Options::visit(OptionVisitor& visitor) {
  visitor.number({.key = "from", .meaning = "factor before the ramp", .unit = "1"}, from);
  visitor.number({.key = "to", .meaning = "factor after the ramp", .unit = "1"}, to);
  visitor.number({.key = "start",
                  .meaning = "time at which the ramp starts",
                  .unit = "s",
                  .range = Range::non_negative()},
                 start);
  visitor.number(
      {.key = "duration", .meaning = "length of the ramp", .unit = "s", .range = Range::positive()},
      duration);
}

PiecewiseLinear RampGesture::factor(double /*duration*/) const {
  return {{options_.start, options_.start + options_.duration}, {options_.from, options_.to}};
}

}  // namespace modcal
