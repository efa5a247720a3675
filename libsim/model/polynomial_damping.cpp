#include "libsim/model/polynomial_damping.hpp"

namespace modcal {

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

}  // namespace modcal
