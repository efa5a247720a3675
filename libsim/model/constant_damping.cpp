#include "libsim/model/constant_damping.hpp"

namespace modcal {

void ConstantDamping::Options::visit(OptionVisitor& visitor) {
  visitor.number({.key = "ratio",
                  .meaning = "damping ratio of every mode",
                  .unit = "1",
                  .range = {0.0, 1.0, true, false}},
                 ratio);
}

double ConstantDamping::ratio(const DampedMode& /*mode*/) const { return options_.ratio; }

}  // namespace modcal
