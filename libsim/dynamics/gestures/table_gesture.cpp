#include "libsim/dynamics/gestures/table_gesture.hpp"

namespace modcal {

void TableGesture::Options::visit(OptionVisitor& visitor) {
  visitor.numbers({.key = "times",
                   .meaning = "times of the points, strictly rising",
                   .unit = "s",
                   .required = true},
                  times);
  visitor.numbers(
      {.key = "factors", .meaning = "factors at these times", .unit = "1", .required = true},
      factors);
}

}  // namespace modcal
