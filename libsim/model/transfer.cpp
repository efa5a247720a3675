#include "libsim/model/transfer.hpp"

#include <cassert>
#include <cmath>
#include <numbers>

#include "libsim/base/words.hpp"
#include "libsim/model/tuning.hpp"

namespace modcal {
namespace {

using std::numbers::pi;

enum class Remainder { kAuto, kLaw, kNone };
constexpr std::array<std::string_view, 3> kRemainders = {"auto", "law", "none"};
enum class Reaction { kTension, kSupport, kAuto };
constexpr std::array<std::string_view, 3> kReactions = {"tension", "support", "auto"};

ModalModel model_with(const ModalBasis& basis, std::vector<SensorKind> sensors) {
  ModalModel model{.sensors = std::move(sensors)};
  for (std::size_t i = 0; i < basis.size(); ++i) {
    model.poles.push_back({basis.omega[i], basis.zeta[i]});
  }
  return model;
}

double ideal_omega(const ModalBasis& basis, std::size_t n) {
  const double density = 2.0 * basis.mass[n - 1] / basis.length;
  return static_cast<double>(n) * pi / basis.length * std::sqrt(basis.tension / density);
}

double stiffening(double inharmonicity, std::size_t n) {
  return 1.0 + inharmonicity * static_cast<double>(n * n);
}

// sinh(a x)/sinh(a π) and cosh(a x)/sinh(a π) for 0 <= x <= π without overflow.
double sinh_ratio(double a, double x) {
  return std::exp(a * (x - pi)) * std::expm1(-2.0 * a * x) / std::expm1(-2.0 * a * pi);
}
double cosh_ratio(double a, double x) {
  return -std::exp(a * (x - pi)) * (1.0 + std::exp(-2.0 * a * x)) / std::expm1(-2.0 * a * pi);
}

// Σ_n sin(nx)/(n (1 + B n²)), 0 <= x <= π.
double sine_series(double x, double inharmonicity) {
  if (x <= 0.0) return 0.0;
  const double ideal = 0.5 * (pi - x);
  if (inharmonicity == 0.0) return ideal;
  return ideal - 0.5 * pi * sinh_ratio(1.0 / std::sqrt(inharmonicity), pi - x);
}

// Σ_n cos(ny)/(n² (1 + B n²)), 0 <= y <= 2π.
double cosine_series(double y, double inharmonicity) {
  const double ideal = pi * pi / 6.0 - 0.5 * pi * y + 0.25 * y * y;
  if (inharmonicity == 0.0) return ideal;
  const double a = 1.0 / std::sqrt(inharmonicity);
  return ideal - 0.5 * pi / a * cosh_ratio(a, std::abs(pi - y)) + 0.5 / (a * a);
}

// −Σ c_n/ω_n⁴ over the modes above the highest one, by the law: what is left of Σ c_n/(ω_n² + s²)
// when its constant is taken, over s².
StaticResponse slope_beyond(const ModalBasis& basis, double contact, bool bending) {
  if (basis.size() == 0) return {};
  const double law = inharmonicity_of(basis);
  const double mass = basis.mass.back(), ideal = ideal_omega(basis, basis.size());
  const double unit = ideal / static_cast<double>(basis.size());
  StaticResponse slope;
  for (std::size_t n = basis.size() + 1; n <= basis.size() + kRemainderModes; ++n) {
    const double number = static_cast<double>(n), stiff = stiffening(law, n);
    const double shape = sine_shape(n, contact / basis.length);
    const double square = number * number * unit * unit * stiff;
    const double by = shape / (mass * square * square);
    const double gain = basis.tension * number * pi / basis.length * (bending ? stiff : 1.0);
    slope.reaction[0] += gain * by;
    slope.reaction[1] += n % 2 == 1 ? gain * by : -gain * by;
    slope.compliance -= shape * by;
  }
  return slope;
}

}  // namespace

void SupportOptions::visit(OptionVisitor& visitor) {
  visitor("remainder",
          "the modes above the highest stated one; law: they answer as the law of "
          "the string has them, none: there are none, auto: law for recorded data",
          {.choices = choices_of(kRemainders)}, remainder);
  visitor(
      "reaction",
      "what the sensors at the ends feel; tension: T dy/dx, support: the "
      "bending of a stiff string too, 1 + B n^2 times as much in mode n, auto: the tension, and "
      "of a record the deviations hold both",
      {.choices = choices_of(kReactions)}, reaction);
}

StringSupport SupportOptions::support(bool recorded) const {
  const auto wanted = enum_of<Remainder>(kRemainders, "remainder", remainder);
  return {.remainder = wanted == Remainder::kLaw || (wanted == Remainder::kAuto && recorded),
          .bending = bending().value_or(false),
          .bending_open = recorded && !bending()};
}

std::optional<bool> SupportOptions::bending() const {
  const auto stated = enum_of<Reaction>(kReactions, "reaction", reaction);
  if (stated == Reaction::kAuto) return std::nullopt;
  return stated == Reaction::kSupport;
}

std::vector<double> reaction_gains(const ModalBasis& basis, End end) {
  std::vector<double> gains(basis.size());
  for (std::size_t i = 0; i < gains.size(); ++i) {
    const double slope = basis.tension * static_cast<double>(i + 1) * pi / basis.length;
    const bool odd = i % 2 == 0;  // mode number n = i + 1
    gains[i] = end == End::kLeft || odd ? -slope : slope;
  }
  return gains;
}

ModalModel end_reactions(const ModalBasis& basis, std::span<const double> shape) {
  assert(shape.size() == basis.size());
  ModalModel model = model_with(basis, {SensorKind::kForce, SensorKind::kForce});
  for (const End end : {End::kLeft, End::kRight}) {
    const std::vector<double> gains = reaction_gains(basis, end);
    for (std::size_t i = 0; i < gains.size(); ++i) {
      model.constants.push_back(gains[i] * (shape[i] / basis.mass[i]));
    }
  }
  return model;
}

ModalModel end_reactions(const ModalBasis& basis, double contact) {
  return end_reactions(basis, basis.shape_at(contact));
}

ModalModel end_reaction_slopes(const ModalBasis& basis, double contact) {
  std::vector<double> slope(basis.size());
  for (std::size_t i = 0; i < slope.size(); ++i) {
    const double n = static_cast<double>(i + 1);
    const double half_turns = std::remainder(n * contact / basis.length, 2.0);
    slope[i] = n * pi / basis.length * std::cos(pi * half_turns);
  }
  return end_reactions(basis, slope);
}

ModalModel string_model(const ModalBasis& basis, double contact, const StringSupport& support) {
  const std::vector<double> shape = basis.shape_at(contact);
  ModalModel model = end_reactions(basis, shape);
  if (support.bending) {
    const double law = inharmonicity_of(basis);
    for (std::size_t i = 0; i < model.constants.size(); ++i) {
      model.constants[i] *= stiffening(law, i % basis.size() + 1);
    }
  }
  model.sensors.push_back(SensorKind::kDisplacement);
  for (std::size_t i = 0; i < shape.size(); ++i) {
    model.constants.push_back(shape[i] * (shape[i] / basis.mass[i]));
  }
  if (!support.remainder) return model;
  const StaticResponse all = static_response(basis, contact, support.bending);
  const StaticResponse kept = static_response_of_modes(basis, contact, support.bending);
  const StaticResponse slope = slope_beyond(basis, contact, support.bending);
  for (std::size_t r = 0; r < 2; ++r) {
    model.residuals.push_back(
        {.constant = all.reaction[r] - kept.reaction[r], .above = slope.reaction[r]});
  }
  model.residuals.push_back(
      {.constant = all.compliance - kept.compliance, .above = slope.compliance});
  return model;
}

std::vector<Complex> reaction_transfer(const ModalBasis& basis, double contact, End end,
                                       const FrequencyGrid& grid) {
  const auto sensor = static_cast<std::size_t>(end);
  return end_reactions(basis, contact).with_sensors({sensor}).transfer(grid)[0];
}

std::vector<Complex> contact_receptance(const ModalBasis& basis, double contact,
                                        const FrequencyGrid& grid) {
  return string_model(basis, contact).with_sensors({2}).transfer(grid)[0];
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
  const double x = pi * contact / basis.length;
  StaticResponse response;
  response.reaction[0] = -2.0 / pi * sine_series(x, of_reactions);
  response.reaction[1] = -2.0 / pi * sine_series(pi - x, of_reactions);
  // Σ φ²/(m ω_n²) with m ω_n² = T π² n² (1 + B n²)/(2 L) and φ² = (1 − cos 2nx)/2.
  response.compliance = basis.length / (basis.tension * pi * pi) *
                        (cosine_series(0.0, law) - cosine_series(2.0 * x, law));
  return response;
}

StaticResponse static_response_of_modes(const ModalBasis& basis, double contact, bool bending) {
  const double law = inharmonicity_of(basis);
  const std::vector<double> shape = basis.shape_at(contact);
  const std::array gains = {reaction_gains(basis, End::kLeft), reaction_gains(basis, End::kRight)};
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

}  // namespace modcal
