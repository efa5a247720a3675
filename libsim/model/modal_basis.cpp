#include "libsim/model/modal_basis.hpp"

#include <cmath>
#include <numbers>

namespace modcal {

double sine_shape(std::size_t n, double relative_position) {
  // remainder() and the fold are exact, so sin sees an argument in [-π/2, π/2] that carries only
  // the rounding of n ξ, and nodes give 0.
  double half_turns = std::remainder(static_cast<double>(n) * relative_position, 2.0);
  if (std::abs(half_turns) > 0.5) half_turns = std::copysign(1.0, half_turns) - half_turns;
  return std::sin(std::numbers::pi * half_turns);
}

double ModalBasis::frequency(std::size_t index) const {
  return omega[index] / (2.0 * std::numbers::pi);
}

std::vector<double> frequencies_of(const ModalBasis& basis) {
  std::vector<double> frequencies(basis.size());
  for (std::size_t n = 0; n < basis.size(); ++n) frequencies[n] = basis.frequency(n);
  return frequencies;
}

std::vector<double> ModalBasis::shape_at(double x) const {
  MODCAL_REQUIRE(x >= 0.0 && x <= length,
                 "position {:g} m is outside the string: it must lie in [0, {:g}] m", x, length);
  std::vector<double> shape(size());
  for (std::size_t i = 0; i < shape.size(); ++i) shape[i] = sine_shape(i + 1, x / length);
  return shape;
}

ModalBasis make_modal_basis(const StringModel& string) {
  MODCAL_REQUIRE(string.length > 0.0 && string.linear_density > 0.0 && string.fundamental > 0.0,
                 "a string needs length, linear density and fundamental > 0; got {:g} m, {:g} "
                 "kg/m, {:g} Hz",
                 string.length, string.linear_density, string.fundamental);
  MODCAL_REQUIRE(string.inharmonicity >= 0.0, "inharmonicity {:g} must be >= 0",
                 string.inharmonicity);
  MODCAL_REQUIRE(!string.modes_of_record(),
                 "modes: auto asks a record how many modes it tells: state a number of modes");
  MODCAL_REQUIRE(string.modes >= 1, "{} modes: at least one is needed", string.modes);
  const auto count = static_cast<std::size_t>(string.modes);
  ModalBasis basis;
  basis.length = string.length;
  basis.tension = string.tension();
  basis.omega.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    basis.omega[i] = 2.0 * std::numbers::pi *
                     stiff_string_frequency(string.fundamental, string.inharmonicity, i + 1);
  }
  basis.zeta = string.damping.make()->ratios(basis.omega, {.length = string.length,
                                                           .linear_density = string.linear_density,
                                                           .tension = string.tension(),
                                                           .inharmonicity = string.inharmonicity});
  basis.mass.assign(count, 0.5 * string.linear_density * string.length);
  return basis;
}

ModalBasis with_frequencies(ModalBasis basis, std::span<const double> frequencies) {
  MODCAL_REQUIRE(frequencies.size() == basis.size(),
                 "{} frequencies were given for a basis of {} modes", frequencies.size(),
                 basis.size());
  for (std::size_t i = 0; i < frequencies.size(); ++i) {
    MODCAL_REQUIRE(frequencies[i] > 0.0, "frequency {:g} Hz of mode {} must be > 0", frequencies[i],
                   i + 1);
    basis.omega[i] = 2.0 * std::numbers::pi * frequencies[i];
  }
  return basis;
}

}  // namespace modcal
