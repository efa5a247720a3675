#include "benchmarks/truth/wave.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "benchmarks/truth/wave_step.hpp"

namespace modcal::truth {
namespace {

/// What of (E, C) is asked for.
struct Symbols {
  Series elastic, losing;
};

/// The power series of both symbols with `terms` terms.
Symbols symbols_of(const WaveEquation& equation, const WaveGrid& grid, std::size_t terms) {
  const long double h = static_cast<long double>(equation.length) / grid.intervals;
  const long double k = grid.time_step;
  Series decay(terms, 0.0L), square(terms, 0.0L);
  decay[0] = k * equation.loss;
  if (terms > 1) decay[1] = k * equation.diffusion / (h * h);
  const long double courant = equation.speed * k / h;
  const long double bending = equation.stiffness * k / (h * h);
  if (terms > 1) square[1] = courant * courant;
  if (terms > 2) square[2] = bending * bending;
  const Series decay_square = product(decay, decay);
  Series twice = decay, once = decay;
  for (std::size_t m = 0; m < terms; ++m) {
    square[m] -= decay_square[m];
    twice[m] *= -2.0L;
    once[m] *= -1.0L;
  }
  const Series e2 = exponential(twice), wave = product(exponential(once), cosine_of_root(square));
  Symbols symbols{Series(terms), Series(terms)};
  for (std::size_t m = 0; m < terms; ++m) {
    const long double one = m == 0 ? 1.0L : 0.0L;
    symbols.elastic[m] = one + e2[m] - 2.0L * wave[m];
    symbols.losing[m] = one - e2[m];
  }
  symbols.elastic[0] = 0.0L;  // at rest nothing pulls: s = 0 is a root for θ = 0
  return symbols;
}

SymmetricStencil elastic_stencil(const WaveEquation& equation, const WaveGrid& grid) {
  return matched_stencil(symbols_of(equation, grid, grid.half_width + 1).elastic);
}

SymmetricStencil losing_stencil(const WaveEquation& equation, const WaveGrid& grid) {
  return matched_stencil(symbols_of(equation, grid, grid.loss_half_width + 1).losing);
}

}  // namespace

Wave::Wave(const WaveEquation& equation, const WaveGrid& grid)
    : equation_(equation),
      grid_(grid),
      margin_(grid.half_width + kStepBlock),
      elastic_(elastic_stencil(equation, grid)),
      losing_(losing_stencil(equation, grid)) {
  if (!has_step(grid.half_width, grid.loss_half_width)) {
    throw std::invalid_argument("half-widths of the stencils: (2, 1), (4, 2) or (8, 4)");
  }
  if (grid.intervals < 4 * grid.half_width) {
    throw std::invalid_argument(
        fmt::format("{} cells are too few: at least {}", grid.intervals, 4 * grid.half_width));
  }
  tuned_.assign(elastic_.taps().begin(), elastic_.taps().end());
  // A static force F kinks the string by F/T: E y = g f l with E ≈ e₁θ² has y' jump by g f/(e₁h).
  const double h = spacing();
  const long double leading = symbols_of(equation, grid, 2).elastic[1];
  const double tension = equation.density * equation.speed * equation.speed;
  response_ = static_cast<double>(leading) * h / tension;
  for (std::size_t n = 1; n < grid.intervals; ++n) {
    const double theta = std::numbers::pi * static_cast<double>(n) / grid.intervals;
    const double e = elastic_.symbol(theta), root = std::sqrt(1.0 - losing_.symbol(theta));
    // |z| < 1 and complex: (1 − √c₂)² < E < (1 + √c₂)².
    if (!(root <= 1.0) || !(e > (1.0 - root) * (1.0 - root)) ||
        !(e < (1.0 + root) * (1.0 + root))) {
      throw std::invalid_argument(fmt::format(
          "mode {} of the grid is not a stable oscillation at {:g} Hz: raise the internal rate or "
          "take fewer cells",
          n, 1.0 / grid.time_step));
    }
  }
  y_.resize(grid.intervals + 1 + 2 * margin_);
  change_ = last_y_ = last_change_ = y_;
}

void Wave::mirror(std::vector<double>& values) const {
  double* v = inner(values);
  const std::ptrdiff_t last = static_cast<std::ptrdiff_t>(grid_.intervals);
  v[0] = v[last] = 0.0;
  for (std::ptrdiff_t j = 1; j <= static_cast<std::ptrdiff_t>(grid_.half_width); ++j) {
    v[-j] = -v[j];
    v[last + j] = -v[last - j];
  }
}

void Wave::advance() {
  std::swap(y_, last_y_);
  std::swap(change_, last_change_);
  step(grid_.half_width, {.elastic = tuned_.data(),
                          .losing = losing_.taps().data(),
                          .y = inner(last_y_),
                          .change = inner(last_change_),
                          .new_y = inner(y_),
                          .new_change = inner(change_),
                          .end = grid_.intervals});
  mirror(y_);
  mirror(change_);
}

void Wave::retune(double relative) {
  if (slope_.empty()) {
    constexpr double kStep = 1e-4;
    WaveEquation tighter = equation_;
    tighter.speed *= std::sqrt(1.0 + kStep);
    const SymmetricStencil stencil = elastic_stencil(tighter, grid_);
    for (std::size_t i = 0; i < tuned_.size(); ++i) {
      slope_.push_back((stencil.taps()[i] - elastic_.taps()[i]) / kStep);
    }
  }
  for (std::size_t i = 0; i < tuned_.size(); ++i) {
    tuned_[i] = elastic_.taps()[i] + relative * slope_[i];
  }
}

void Wave::push(const Interpolation& contact, double force) {
  double* y = inner(y_) + contact.first;
  double* change = inner(change_) + contact.first;
  for (std::size_t i = 0; i < contact.weights.size(); ++i) {
    const double moved = response_ * force * contact.weights[i];
    y[i] += moved;
    change[i] += moved;
  }
}

void Wave::push_everywhere(const std::vector<double>& load, double factor) {
  double *y = inner(y_), *change = inner(change_);
  const double scale = response_ * factor;
  for (std::size_t j = 1; j < grid_.intervals; ++j) {
    const double moved = scale * load[j];
    y[j] += moved;
    change[j] += moved;
  }
  mirror(y_);
  mirror(change_);
}

double Wave::mobility(const Interpolation& contact) const {
  double square = 0.0;
  for (const double w : contact.weights) square += w * w;
  return response_ * square / (2.0 * grid_.time_step);
}

WaveMode Wave::mode(std::size_t n) const {
  const double theta = std::numbers::pi * static_cast<double>(n) / grid_.intervals;
  const double log_c2 = std::log1p(-losing_.symbol(theta));
  const double root = std::exp(0.5 * log_c2);
  // sin²(φ/2) = (E − (1 − √c₂)²)/4√c₂ of z = √c₂ exp(±iφ).
  const double square = -std::expm1(0.5 * log_c2);
  const double sine = std::sqrt((elastic_.symbol(theta) - square * square) / (4.0 * root));
  const double phase = 2.0 * std::asin(sine);
  const double decay = -0.5 * log_c2 / grid_.time_step;
  return {.omega = std::hypot(phase / grid_.time_step, decay), .decay = decay};
}

void Wave::set_rest(const std::vector<double>& displacement) {
  std::copy_n(displacement.begin(), grid_.intervals + 1, inner(y_));
  mirror(y_);
  // Half a step of the acceleration: v = (d^n + d^{n+1})/2k = 0 at this level but for losses.
  for (std::size_t j = 1; j < grid_.intervals; ++j) {
    inner(change_)[j] = 0.5 * value_at(elastic_.taps(), inner(y_) + j);
    inner(last_y_)[j] = inner(y_)[j] - inner(change_)[j];
  }
  mirror(change_);
  mirror(last_y_);
}

double Wave::energy() const {
  const double *moved = change(), *now = y(), *before = last_y_.data() + margin_;
  double sum = 0.0;
  for (std::size_t j = 1; j < grid_.intervals; ++j) {
    sum += moved[j] * moved[j] + now[j] * value_at(elastic_.taps(), before + j);
  }
  return 0.5 * sum / response_;
}

double Wave::lost() const {
  const double *moved = change(), *before = last_change();
  double sum = 0.0;
  for (std::size_t j = 1; j < grid_.intervals; ++j) {
    sum += 0.5 * (moved[j] + before[j]) * value_at(losing_.taps(), before + j);
  }
  return sum / response_;
}

}  // namespace modcal::truth
