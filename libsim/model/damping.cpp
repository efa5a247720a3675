#include "libsim/model/damping.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "libsim/base/dense_solvers.hpp"

namespace modcal {
namespace {

double polynomial(const std::vector<double>& coefficients, std::size_t n) {
  double value = 0.0;
  for (std::size_t j = coefficients.size(); j-- > 0;) {
    value = value * static_cast<double>(n) + coefficients[j];
  }
  return value;
}

}  // namespace

double DampingFit::ratio(std::size_t n) const { return polynomial(coefficients, n); }

std::vector<double> DampingLaw::ratios(std::span<const double> omega,
                                       const StringConstants& string) const {
  std::vector<double> zeta(omega.size());
  for (std::size_t i = 0; i < omega.size(); ++i) {
    zeta[i] = ratio({i, omega[i], string});
    MODCAL_REQUIRE(zeta[i] >= 0.0 && zeta[i] < 1.0,
                   "damping ratio {:g} of mode {} is outside [0, 1): the model needs oscillating "
                   "modes",
                   zeta[i], i + 1);
  }
  return zeta;
}

DampingFit fit_damping(std::span<const std::size_t> mode_numbers, std::span<const double> ratios,
                       std::size_t degree) {
  MODCAL_REQUIRE(mode_numbers.size() == ratios.size(), "{} mode numbers and {} damping ratios",
                 mode_numbers.size(), ratios.size());
  const std::set<std::size_t> distinct(mode_numbers.begin(), mode_numbers.end());
  MODCAL_REQUIRE(distinct.size() == mode_numbers.size(), "a mode is listed twice");
  MODCAL_REQUIRE(distinct.size() > degree,
                 "a polynomial of degree {} needs at least {} modes; {} are given", degree,
                 degree + 1, distinct.size());
  MODCAL_REQUIRE(*distinct.begin() >= 1, "modes are numbered from 1");
  // Columns (n/top)^j: of comparable size, so that QR sees the condition of the abscissae alone.
  const double top = static_cast<double>(*distinct.rbegin());
  const auto rows = static_cast<Eigen::Index>(ratios.size());
  const auto columns = static_cast<Eigen::Index>(degree + 1);
  Eigen::MatrixXd matrix(rows, columns);
  Eigen::VectorXd right(rows);
  for (Eigen::Index i = 0; i < rows; ++i) {
    const auto index = static_cast<std::size_t>(i);
    MODCAL_REQUIRE(std::isfinite(ratios[index]), "damping ratio {:g} of mode {} is not finite",
                   ratios[index], mode_numbers[index]);
    right[i] = ratios[index];
    const double abscissa = static_cast<double>(mode_numbers[index]) / top;
    matrix(i, 0) = 1.0;
    for (Eigen::Index j = 1; j < columns; ++j) matrix(i, j) = matrix(i, j - 1) * abscissa;
  }
  const Eigen::VectorXd solution = ThinQr(matrix).solve(right);
  DampingFit fit;
  double power = 1.0;
  for (const double value : solution) {
    fit.coefficients.push_back(value / power);
    power *= top;
  }
  fit.rms_residual =
      std::sqrt((matrix * solution - right).squaredNorm() / static_cast<double>(rows));
  return fit;
}

void ConstantDamping::Options::visit(OptionVisitor& visitor) {
  visitor("ratio", "damping ratio of every mode", {.range = {0.0, 1.0, true, false}}, ratio);
}

double ConstantDamping::ratio(const DampedMode& /*mode*/) const { return options_.ratio; }

void PolynomialDamping::Options::visit(OptionVisitor& visitor) {
  visitor("coefficients", "c_0, c_1, ... of zeta_n = sum_j c_j n^j, n = mode number", coefficients);
}

double PolynomialDamping::ratio(const DampedMode& mode) const {
  return polynomial(options_.coefficients, mode.index + 1);
}

void TableDamping::Options::visit(OptionVisitor& visitor) {
  visitor("frequencies", "frequencies of the points, strictly rising",
          {.unit = "Hz", .range = Range::non_negative(), .required = true}, frequencies);
  visitor("ratios", "damping ratios at these frequencies",
          {.range = {0.0, 1.0, true, false}, .required = true}, ratios);
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
  visitor("modes", "numbers of the modes whose damping was measured",
          {.range = Range::at_least(1), .required = true}, modes);
  visitor("ratios",
          "their damping ratios; all modes, these too, have those of the polynomial (type: table "
          "takes ratios as they are)",
          {.range = {0.0, 1.0, true, false}, .required = true}, ratios);
  visitor("degree", "degree of the polynomial of the mode number", {.range = Range::closed(0, 10)},
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
  visitor("friction", "loss factor eta_F of internal friction",
          {.range = Range::non_negative(), .required = true}, friction);
  visitor("air", "loss rate eta_A of the air",
          {.unit = "1/s", .range = Range::non_negative(), .required = true}, air);
  visitor("bending", "loss factor eta_B of bending",
          {.range = Range::non_negative(), .required = true}, bending);
}

double WoodhouseDamping::ratio(const DampedMode& mode) const {
  const double n = static_cast<double>(mode.index + 1);
  const double stiffness = mode.string.inharmonicity * n * n;
  const double loss = options_.friction + options_.air / mode.omega + options_.bending * stiffness;
  return 0.5 * loss / (1.0 + stiffness);
}

void ValetteCuestaDamping::Options::visit(OptionVisitor& visitor) {
  visitor("diameter", "diameter d of the string",
          {.unit = "m", .range = Range::positive(), .required = true}, diameter);
  visitor("loss_angle", "viscoelastic loss angle delta of bending",
          {.range = Range::non_negative(), .required = true}, loss_angle);
  visitor("constant", "1/Q of dislocations and thermoelasticity, the same for all modes",
          {.range = Range::non_negative(), .required = true}, constant);
  visitor("air_viscosity", "dynamic viscosity of the air",
          {.unit = "Pa s", .range = Range::non_negative()}, air_viscosity);
  visitor("air_density", "density of the air", {.unit = "kg/m3", .range = Range::non_negative()},
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

Registry<DampingLaw> DampingLaw::registry() {
  static constexpr std::array kTable = {
      entry_of<DampingLaw, ConstantDamping>("constant", "one damping ratio for all modes"),
      entry_of<DampingLaw, MeasuredDamping>(
          "measured", "a polynomial of the mode number through the ratios of some modes"),
      entry_of<DampingLaw, PolynomialDamping>("polynomial",
                                              "damping ratio as a polynomial of the mode number"),
      entry_of<DampingLaw, TableDamping>("table", "damping ratio against frequency"),
      entry_of<DampingLaw, ValetteCuestaDamping>(
          "valette_cuesta", "losses of a metal string: air, viscoelasticity, dislocations"),
      entry_of<DampingLaw, WoodhouseDamping>("woodhouse",
                                             "losses by friction, air and bending of a string"),
  };
  return kTable;
}

}  // namespace modcal
