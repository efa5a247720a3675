#include "libinverse/joint/string_transfer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace modcal {
namespace {

constexpr double kPi = std::numbers::pi;

double ideal_omega(const ModalBasis& basis, std::size_t n) {
  const double density = 2.0 * basis.mass[n - 1] / basis.length;
  return static_cast<double>(n) * kPi / basis.length * std::sqrt(basis.tension / density);
}

double stiffening(double inharmonicity, std::size_t n) {
  return 1.0 + inharmonicity * static_cast<double>(n * n);
}

// sinh(a x)/sinh(a π) and cosh(a x)/sinh(a π) for 0 <= x <= π without overflow.
double sinh_ratio(double a, double x) {
  return std::exp(a * (x - kPi)) * std::expm1(-2.0 * a * x) / std::expm1(-2.0 * a * kPi);
}
double cosh_ratio(double a, double x) {
  return -std::exp(a * (x - kPi)) * (1.0 + std::exp(-2.0 * a * x)) / std::expm1(-2.0 * a * kPi);
}

// Σ_n sin(nx)/(n (1 + B n²)), 0 <= x <= π.
double sine_series(double x, double inharmonicity) {
  if (x <= 0.0) return 0.0;
  const double ideal = 0.5 * (kPi - x);
  if (inharmonicity == 0.0) return ideal;
  return ideal - 0.5 * kPi * sinh_ratio(1.0 / std::sqrt(inharmonicity), kPi - x);
}

// Σ_n cos(ny)/(n² (1 + B n²)), 0 <= y <= 2π.
double cosine_series(double y, double inharmonicity) {
  const double ideal = kPi * kPi / 6.0 - 0.5 * kPi * y + 0.25 * y * y;
  if (inharmonicity == 0.0) return ideal;
  const double a = 1.0 / std::sqrt(inharmonicity);
  return ideal - 0.5 * kPi / a * cosh_ratio(a, std::abs(kPi - y)) + 0.5 / (a * a);
}

void add_scaled(std::vector<Complex>& transfer, double constant) {
  for (Complex& value : transfer) value += constant;
}

void read_by_sensor(const FrequencyGrid& grid, double gain, double delay,
                    std::vector<Complex>& transfer) {
  if (gain == 1.0 && delay == 0.0) return;
  const double magnitude = gain * std::exp(-grid.sigma * delay);
  for (std::size_t k = 0; k < transfer.size(); ++k) {
    transfer[k] *= std::polar(1.0, -grid.omega(k) * delay) * magnitude;
  }
}

}  // namespace

void TransferOptions::visit(OptionVisitor& visitor) {
  visitor.text({.key = "static_remainder",
                .meaning = "static response of the modes above the highest stated one; auto: for "
                           "recorded data",
                .choices = {"auto", "on", "off"}},
               static_remainder);
  visitor.flag({.key = "bending",
                .meaning = "the supports of a stiff string feel its bending too: reactions times "
                           "1 + B n^2 in mode n"},
               bending);
}

void SensorOptions::visit(OptionVisitor& visitor) {
  visitor.number(
      {.key = "gain1", .meaning = "gain of the sensor at x = 0", .range = Range::positive()},
      gain[0]);
  visitor.number(
      {.key = "gain2", .meaning = "gain of the sensor at x = L", .range = Range::positive()},
      gain[1]);
  visitor.number({.key = "delay1", .meaning = "delay of the channel of x = 0", .unit = "s"},
                 delay[0]);
  visitor.number({.key = "delay2", .meaning = "delay of the channel of x = L", .unit = "s"},
                 delay[1]);
}

double inharmonicity_of(const ModalBasis& basis) {
  double product = 0.0, square = 0.0;
  for (std::size_t n = 1; n <= basis.size(); ++n) {
    const double ratio = basis.omega[n - 1] / ideal_omega(basis, n);
    const double n_squared = static_cast<double>(n * n);
    product += (ratio * ratio - 1.0) * n_squared;
    square += n_squared * n_squared;
  }
  const double fitted = square > 0.0 ? product / square : 0.0;
  // Rounding of the frequencies is no stiffness.
  return fitted > 1e-14 ? fitted : 0.0;
}

StaticResponse static_response(const ModalBasis& basis, double contact, bool bending) {
  const double law = inharmonicity_of(basis);
  const double of_reactions = bending ? 0.0 : law;
  const double x = kPi * contact / basis.length;
  StaticResponse response;
  response.reaction[0] = -2.0 / kPi * sine_series(x, of_reactions);
  response.reaction[1] = -2.0 / kPi * sine_series(kPi - x, of_reactions);
  // Σ φ²/(m ω_n²) with m ω_n² = T π² n² (1 + B n²)/(2 L) and φ² = (1 − cos 2nx)/2.
  response.compliance = basis.length / (basis.tension * kPi * kPi) *
                        (cosine_series(0.0, law) - cosine_series(2.0 * x, law));
  return response;
}

StaticResponse static_response_of_modes(const ModalBasis& basis, double contact, bool bending) {
  const double law = inharmonicity_of(basis);
  const std::vector<double> shape = basis.shape_at(contact);
  const std::vector<double> gains[2] = {reaction_gains(basis, End::kLeft),
                                        reaction_gains(basis, End::kRight)};
  StaticResponse response;
  for (std::size_t n = 1; n <= basis.size(); ++n) {
    const double ideal = ideal_omega(basis, n);
    const double stiffness = basis.mass[n - 1] * ideal * ideal * stiffening(law, n);
    const double factor = (bending ? stiffening(law, n) : 1.0) * shape[n - 1] / stiffness;
    for (std::size_t r = 0; r < 2; ++r) response.reaction[r] += gains[r][n - 1] * factor;
    response.compliance += shape[n - 1] * shape[n - 1] / stiffness;
  }
  return response;
}

StringTransfer string_transfer(const ModalBasis& basis, double contact, const FrequencyGrid& grid,
                               bool static_remainder, bool bending, const SensorOptions& sensors) {
  const double law = bending ? inharmonicity_of(basis) : 0.0;
  const std::vector<double> shape = basis.shape_at(contact);
  StringTransfer transfer;
  for (std::size_t r = 0; r < 2; ++r) {
    std::vector<double> numerator = reaction_gains(basis, r == 0 ? End::kLeft : End::kRight);
    for (std::size_t i = 0; i < numerator.size(); ++i) {
      numerator[i] *= shape[i] * stiffening(law, i + 1);
    }
    transfer.reaction[r].resize(grid.bins);
    modal_sum(basis, numerator, grid, transfer.reaction[r]);
  }
  transfer.receptance = contact_receptance(basis, contact, grid);
  if (static_remainder) {
    const StaticResponse all = static_response(basis, contact, bending);
    const StaticResponse kept = static_response_of_modes(basis, contact, bending);
    for (std::size_t r = 0; r < 2; ++r) {
      add_scaled(transfer.reaction[r], all.reaction[r] - kept.reaction[r]);
    }
    add_scaled(transfer.receptance, all.compliance - kept.compliance);
  }
  for (std::size_t r = 0; r < 2; ++r) {
    read_by_sensor(grid, sensors.gain[r], sensors.delay[r], transfer.reaction[r]);
  }
  return transfer;
}

}  // namespace modcal
