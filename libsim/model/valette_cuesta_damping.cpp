#include "libsim/model/valette_cuesta_damping.hpp"

#include <cmath>
#include <numbers>

namespace modcal {

void ValetteCuestaDamping::Options::visit(OptionVisitor& visitor) {
  visitor.number({.key = "diameter",
                  .meaning = "diameter d of the string",
                  .unit = "m",
                  .range = Range::positive(),
                  .required = true},
                 diameter);
  visitor.number({.key = "loss_angle",
                  .meaning = "viscoelastic loss angle delta of bending",
                  .unit = "1",
                  .range = Range::non_negative(),
                  .required = true},
                 loss_angle);
  visitor.number({.key = "constant",
                  .meaning = "1/Q of dislocations and thermoelasticity, the same for all modes",
                  .unit = "1",
                  .range = Range::non_negative(),
                  .required = true},
                 constant);
  visitor.number({.key = "air_viscosity",
                  .meaning = "dynamic viscosity of the air",
                  .unit = "Pa s",
                  .range = Range::non_negative()},
                 air_viscosity);
  visitor.number({.key = "air_density",
                  .meaning = "density of the air",
                  .unit = "kg/m3",
                  .range = Range::non_negative()},
                 air_density);
}

double ValetteCuestaDamping::ratio(const DampedMode& mode) const {
  using std::numbers::pi;
  const StringConstants& string = mode.string;
  const double frequency = mode.omega / (2.0 * pi);
  const double viscosity = options_.air_viscosity;
  const double resistance =
      2.0 * pi * viscosity +
      2.0 * pi * options_.diameter * std::sqrt(pi * viscosity * options_.air_density * frequency);
  const double air = resistance / (string.linear_density * mode.omega);
  const double bending_stiffness =
      string.inharmonicity * string.tension * string.length * string.length / (pi * pi);
  const double viscoelastic = string.linear_density * bending_stiffness * options_.loss_angle *
                              mode.omega * mode.omega / (string.tension * string.tension);
  return 0.5 * (air + viscoelastic + options_.constant);
}

}  // namespace modcal
