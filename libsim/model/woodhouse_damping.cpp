#include "libsim/model/woodhouse_damping.hpp"

namespace modcal {

void WoodhouseDamping::Options::visit(OptionVisitor& visitor) {
  visitor.number({.key = "friction",
                  .meaning = "loss factor eta_F of internal friction",
                  .unit = "1",
                  .range = Range::non_negative(),
                  .required = true},
                 friction);
  visitor.number({.key = "air",
                  .meaning = "loss rate eta_A of the air",
                  .unit = "1/s",
                  .range = Range::non_negative(),
                  .required = true},
                 air);
  visitor.number({.key = "bending",
                  .meaning = "loss factor eta_B of bending",
                  .unit = "1",
                  .range = Range::non_negative(),
                  .required = true},
                 bending);
}

double WoodhouseDamping::ratio(const DampedMode& mode) const {
  const double n = static_cast<double>(mode.index + 1);
  const double stiffness = mode.string.inharmonicity * n * n;
  const double loss = options_.friction + options_.air / mode.omega + options_.bending * stiffness;
  return 0.5 * loss / (1.0 + stiffness);
}

}  // namespace modcal
