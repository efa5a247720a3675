#include "libsim/model/damping_laws.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"

namespace modcal {

void ConstantDamping::Options::visit(OptionVisitor& visitor) {
  visitor.number({.key = "ratio",
                  .meaning = "damping ratio of every mode",
                  .unit = "1",
                  .range = {0.0, 1.0, true, false}},
                 ratio);
}

double ConstantDamping::ratio(const DampedMode& /*mode*/) const { return options_.ratio; }

void PolynomialDamping::Options::visit(OptionVisitor& visitor) {
  visitor.numbers({.key = "coefficients",
                   .meaning = "c_0, c_1, ... of zeta_n = sum_j c_j n^j, n = mode number",
                   .unit = "1"},
                  coefficients);
}

double PolynomialDamping::ratio(const DampedMode& mode) const {
  const double n = static_cast<double>(mode.index + 1);
  double value = 0.0;
  for (std::size_t j = options_.coefficients.size(); j-- > 0;) {
    value = value * n + options_.coefficients[j];
  }
  return value;
}

void TableDamping::Options::visit(OptionVisitor& visitor) {
  visitor.numbers({.key = "frequencies",
                   .meaning = "frequencies of the points, strictly rising",
                   .unit = "Hz",
                   .range = Range::non_negative(),
                   .required = true},
                  frequencies);
  visitor.numbers({.key = "ratios",
                   .meaning = "damping ratios at these frequencies",
                   .unit = "1",
                   .range = {0.0, 1.0, true, false},
                   .required = true},
                  ratios);
}

TableDamping::TableDamping(Options options) : options_(std::move(options)) {
  const std::vector<double>& f = options_.frequencies;
  MODCAL_REQUIRE(f.size() == options_.ratios.size() && !f.empty(),
                 "{} frequencies and {} damping ratios were given: each frequency needs one ratio",
                 f.size(), options_.ratios.size());
  for (std::size_t i = 1; i < f.size(); ++i) {
    MODCAL_REQUIRE(f[i] > f[i - 1],
                   "the frequencies of a damping table must rise, but {:g} Hz follows {:g} Hz",
                   f[i], f[i - 1]);
  }
}

double TableDamping::ratio(const DampedMode& mode) const {
  const std::vector<double>&f = options_.frequencies, &zeta = options_.ratios;
  const double frequency = mode.omega / (2.0 * std::numbers::pi);
  const auto after =
      static_cast<std::size_t>(std::upper_bound(f.begin(), f.end(), frequency) - f.begin());
  if (after == 0) return zeta.front();
  if (after == f.size()) return zeta.back();
  const double share = (frequency - f[after - 1]) / (f[after] - f[after - 1]);
  return zeta[after - 1] + share * (zeta[after] - zeta[after - 1]);
}

void MeasuredDamping::Options::visit(OptionVisitor& visitor) {
  visitor.integers({.key = "modes",
                    .meaning = "numbers of the modes whose damping was measured",
                    .range = Range::at_least(1),
                    .required = true},
                   modes);
  visitor.numbers({.key = "ratios",
                   .meaning = "their damping ratios",
                   .unit = "1",
                   .range = {0.0, 1.0, true, false},
                   .required = true},
                  ratios);
  visitor.integer({.key = "degree",
                   .meaning = "degree of the polynomial of the mode number",
                   .range = Range::closed(0, 10)},
                  degree);
}

MeasuredDamping::MeasuredDamping(const Options& options) {
  MODCAL_REQUIRE(options.modes.size() == options.ratios.size(),
                 "{} modes and {} damping ratios were given: each mode needs one ratio",
                 options.modes.size(), options.ratios.size());
  const std::vector<std::size_t> modes(options.modes.begin(), options.modes.end());
  fit_ = fit_damping(modes, options.ratios, static_cast<std::size_t>(options.degree));
}

double MeasuredDamping::ratio(const DampedMode& mode) const { return fit_.ratio(mode.index + 1); }

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
