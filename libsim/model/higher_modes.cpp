#include "libsim/model/higher_modes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "libsim/model/tuning.hpp"

namespace modcal {
namespace {

using std::numbers::pi;

// A number with its derivatives by x_c and B.
struct Varying {
  double value = 0.0, by_contact = 0.0, by_inharmonicity = 0.0;
};

void add(Varying& sum, const Varying& term, double factor) {
  sum.value += factor * term.value;
  sum.by_contact += factor * term.by_contact;
  sum.by_inharmonicity += factor * term.by_inharmonicity;
}

// Σ_{n ≥ 1} of the static terms at ξ, (π/2) A(ξ): A = (1 − ξ) − sinh(β(1 − ξ))/sinh(β), β = π/√B;
// by ξ in the place of x_c.
Varying whole_string(double place, double inharmonicity, bool bending) {
  Varying all{.value = 0.5 * pi * (1.0 - place), .by_contact = -0.5 * pi};
  if (bending || inharmonicity <= 0.0) return all;
  const double beta = pi / std::sqrt(inharmonicity), y = 1.0 - place;
  const double norm = -std::expm1(-2.0 * beta);
  const double sinh = -std::exp(-beta * place) * std::expm1(-2.0 * beta * y) / norm;
  const double cosh = std::exp(-beta * place) * (1.0 + std::exp(-2.0 * beta * y)) / norm;
  const double coth = (1.0 + std::exp(-2.0 * beta)) / norm;
  all.value -= 0.5 * pi * sinh;
  all.by_contact += 0.5 * pi * beta * cosh;
  all.by_inharmonicity = 0.5 * pi * (y * cosh - sinh * coth) * 0.5 * beta / inharmonicity;
  return all;
}

// The static term of mode n, sin(nθ)/(n (1 + B n²)); `turn` = exp(inθ), θ = πξ.
Varying static_term(double n, std::complex<double> turn, double inharmonicity, bool bending) {
  const double stiff = bending ? 1.0 : 1.0 + inharmonicity * n * n;
  const double value = turn.imag() / (n * stiff);
  return {.value = value,
          .by_contact = pi * turn.real() / stiff,
          .by_inharmonicity = bending ? 0.0 : -value * n * n / stiff};
}

// Sums of one parity, f0 = 1/2π: terms before `apart`, and Σ term λ_n T_j(x_n) from there on.
struct ParitySums {
  Varying before;
  std::array<Varying, kRemainderPoints> moments;
};

void add_moments(const Varying& term, double n, double inharmonicity, double interval,
                 std::array<Varying, kRemainderPoints>& moments) {
  const double stiff = 1.0 + inharmonicity * n * n;
  const double lambda = 1.0 / (n * n * stiff);
  const double x = 2.0 * lambda / interval - 1.0;
  const double slope = -n * n / stiff * lambda;  // ∂λ/∂B
  double last = 0.0, chebyshev = 1.0, last_slope = 0.0, chebyshev_slope = 0.0;
  for (std::size_t j = 0; j < kRemainderPoints; ++j) {
    add(moments[j], term, lambda * chebyshev);
    moments[j].by_inharmonicity +=
        term.value * slope * (chebyshev + lambda * chebyshev_slope * 2.0 / interval);
    const double two = j == 0 ? 1.0 : 2.0;
    const double next = two * x * chebyshev - last;
    const double next_slope = two * (chebyshev + x * chebyshev_slope) - last_slope;
    last = chebyshev, chebyshev = next;
    last_slope = chebyshev_slope, chebyshev_slope = next_slope;
  }
}

HigherMode mode_of(bool even, double omega, const Varying& residue, double length) {
  return {.even = even,
          .omega = omega,
          .residue = residue.value,
          .by_contact = residue.by_contact / length,
          .by_inharmonicity = residue.by_inharmonicity};
}

// The modes that stand for many of one parity: `all` of them as in whole_string(). scale: ω0²
// times what makes a static term one of a_n/ω_n².
void add_equivalents(const HigherModeLaw& law, const ParitySums& sums, Varying all, bool even,
                     double length, double scale, std::vector<HigherMode>& modes) {
  const double unit = 2.0 * pi * law.fundamental;
  const double interval = 1.0 / static_cast<double>(law.apart * law.apart);
  add(all, sums.before, -1.0);
  for (std::size_t k = 0; k < kRemainderPoints; ++k) {
    const double angle =
        pi * (static_cast<double>(k) + 0.5) / static_cast<double>(kRemainderPoints);
    const double lambda = 0.5 * interval * (1.0 + std::cos(angle));
    Varying weight;
    for (std::size_t j = 0; j < kRemainderPoints; ++j) {
      const double share = (j == 0 ? 1.0 : 2.0) / static_cast<double>(kRemainderPoints);
      add(weight, sums.moments[j], share * std::cos(static_cast<double>(j) * angle));
    }
    add(all, weight, -1.0 / lambda);
    Varying residue;
    add(residue, weight, scale / (lambda * lambda));
    modes.push_back(mode_of(even, unit / std::sqrt(lambda), residue, length));
  }
  const double far = kRemainderConstantAt * law.highest / law.fundamental;
  Varying residue;
  add(residue, all, scale * far * far);
  modes.push_back(mode_of(even, unit * far, residue, length));
}

}  // namespace

HigherModeLaw HigherModeLaw::above(const ModalBasis& basis, double fundamental,
                                   double inharmonicity, double highest, bool bending) {
  const auto reach =
      static_cast<std::size_t>(std::ceil(std::sqrt(kRemainderApart) * highest / fundamental));
  return {.fundamental = fundamental,
          .inharmonicity = inharmonicity,
          .stated = basis.size(),
          .apart = std::max(basis.size() + 1, reach),
          .highest = highest,
          .bending = bending};
}

std::size_t higher_mode_count(const HigherModeLaw& law) {
  return law.apart - 1 - law.stated + 2 * (kRemainderPoints + 1);
}

std::vector<HigherMode> higher_modes(const HigherModeLaw& law, const ModalBasis& basis,
                                     double contact) {
  const double b = std::max(law.inharmonicity, 0.0);
  const double place = contact / basis.length;
  const double unit = 2.0 * pi * law.fundamental;
  // a_n/ω_n² = scale/ω0² times the static term.
  const double scale = basis.tension * pi / (basis.length * basis.mass.front());
  const std::complex<double> step = std::polar(1.0, pi * place);
  std::complex<double> turn = 1.0;
  std::vector<HigherMode> modes;
  std::array<ParitySums, 2> sums;
  const double interval = 1.0 / static_cast<double>(law.apart * law.apart);
  for (std::size_t n = 1; n < law.apart + kRemainderModes; ++n) {
    const double number = static_cast<double>(n);
    turn *= step;
    const Varying term = static_term(number, turn, b, law.bending);
    const bool even = n % 2 == 0;
    if (n >= law.apart) {
      add_moments(term, number, b, interval, sums[even ? 1 : 0].moments);
      continue;
    }
    add(sums[even ? 1 : 0].before, term, 1.0);
    if (n <= law.stated) continue;
    const double stiff = 1.0 + b * number * number;
    const double bending = law.bending ? stiff : 1.0;
    modes.push_back(
        {.number = n,
         .even = even,
         .omega = unit * number * std::sqrt(stiff),
         .residue = scale * number * bending * turn.imag(),
         .by_contact = scale * number * bending * number * pi / basis.length * turn.real(),
         .by_inharmonicity = law.bending ? scale * number * number * number * turn.imag() : 0.0});
  }
  const Varying left = whole_string(place, b, law.bending);
  Varying right = whole_string(1.0 - place, b, law.bending);
  right.by_contact = -right.by_contact;
  for (const bool even : {false, true}) {
    Varying all;
    add(all, left, 0.5);
    add(all, right, even ? -0.5 : 0.5);
    add_equivalents(law, sums[even ? 1 : 0], all, even, basis.length, scale, modes);
  }
  return modes;
}

}  // namespace modcal
