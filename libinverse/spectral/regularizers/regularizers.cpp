#include "libinverse/spectral/regularizers/regularizers.hpp"

#include <cmath>
#include <numbers>

#include "libinverse/spectral/regularizers/filter_terms.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// Sums over the components with 0 < σ ≤ ε. The residual Σ |b|² (ε − σ)² moves from one ε to the
// next by terms that are all positive, where its expanded form would cancel.
struct ClippedSums {
  double level = 0.0;          // ε
  double power = 0.0;          // Σ |b|²
  double first_moment = 0.0;   // Σ |b|² (ε − σ)
  double second_moment = 0.0;  // Σ |b|² (ε − σ)²
  double solution = 0.0;       // Σ weight |b|² σ²/σ²
  double freedom = 0.0;        // Σ multiplicity σ

  void raise_to(double new_level) {
    const double rise = new_level - level;
    second_moment += rise * (2.0 * first_moment + rise * power);
    first_moment += rise * power;
    level = new_level;
  }

  void add(const SpectralSystem& system, std::size_t i) {
    const double sigma = system.sigma[i];
    const double depth = level - sigma;
    power += system.power[i];
    first_moment += system.power[i] * depth;
    second_moment += system.power[i] * depth * depth;
    solution += system.power[i] * system.solution_weight[i] * sigma * sigma;
    freedom += system.multiplicity[i] * sigma;
  }
};

// Adds solution and freedom of the components that are kept whole, from the largest σ down.
void add_whole(const SpectralSystem& system, std::span<const double> parameters,
               bool (*keeps)(double sigma, double parameter), std::span<CurvePoint> curve) {
  double solution = 0.0, freedom = 0.0;
  std::size_t head = 0;
  for (std::size_t j = parameters.size(); j-- > 0;) {
    for (; head < system.size() && keeps(system.sigma[head], parameters[j]); ++head) {
      solution += system.solution_weight[head] * system.power[head];
      freedom += system.multiplicity[head];
    }
    curve[j].solution_norm += solution;
    curve[j].freedom += freedom;
  }
}

}  // namespace

// The residual is gathered from the smallest σ up and the solution from the largest down: both are
// sums of positive terms, so neither cancels.
void WaterLevel::do_trace_squares(const SpectralSystem& system, std::span<const double> parameters,
                                  std::span<CurvePoint> curve) const {
  double residual = system.outside_power;
  std::size_t tail = system.size();
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    while (tail > 0 && !(system.sigma[tail - 1] > parameters[j])) residual += system.power[--tail];
    curve[j].residual_norm = residual;
  }
  for (CurvePoint& point : curve) point.solution_norm = point.freedom = 0.0;
  add_whole(system, parameters, keeps_above, curve);
}

void WaterLevelClip::do_filter_factors(std::span<const double> sigma, double parameter,
                                       std::span<double> kept, std::span<double> lost) const {
  for (std::size_t i = 0; i < sigma.size(); ++i) {
    kept[i] = sigma[i] <= 0.0 ? 0.0 : sigma[i] < parameter ? sigma[i] / parameter : 1.0;
  }
  for (std::size_t i = 0; i < lost.size(); ++i) {
    lost[i] = sigma[i] <= 0.0        ? 1.0
              : sigma[i] < parameter ? (parameter - sigma[i]) / parameter
                                     : 0.0;
  }
}

void WaterLevelClip::do_trace_squares(const SpectralSystem& system,
                                      std::span<const double> parameters,
                                      std::span<CurvePoint> curve) const {
  double unseen = system.outside_power;
  std::size_t tail = system.size();
  for (; tail > 0 && system.sigma[tail - 1] <= 0.0; --tail) unseen += system.power[tail - 1];
  const std::size_t first_zero = tail;
  ClippedSums clipped;
  for (std::size_t j = 0; j < parameters.size(); ++j) {
    clipped.raise_to(parameters[j]);
    for (; tail > 0 && system.sigma[tail - 1] < parameters[j]; --tail)
      clipped.add(system, tail - 1);
    // Where something is clipped, ε exceeds a positive σ and its reciprocal is finite.
    const double inverse = tail < first_zero ? 1.0 / parameters[j] : 0.0;
    curve[j].residual_norm = unseen + clipped.second_moment * inverse * inverse;
    curve[j].solution_norm = clipped.solution * inverse * inverse;
    curve[j].freedom = clipped.freedom * inverse;
  }
  add_whole(system, parameters, keeps_from, curve);
}

void QuadraticFilter::do_filter_factors(std::span<const double> sigma, double parameter,
                                        std::span<double> kept, std::span<double> lost) const {
  // Ratios rather than σ²/(σ² + λ²), and each factor by its own quotient: nothing cancels, and an
  // overflow of a ratio gives the limit 0.
  for (std::size_t i = 0; i < sigma.size(); ++i) {
    const double ratio = parameter / sigma[i];
    kept[i] = sigma[i] > 0.0 ? 1.0 / (1.0 + ratio * ratio) : 0.0;
  }
  for (std::size_t i = 0; i < lost.size(); ++i) {
    const double ratio = sigma[i] / parameter;
    lost[i] = sigma[i] > 0.0 ? 1.0 / (1.0 + ratio * ratio) : 1.0;
  }
}

void QuadraticFilter::do_trace_squares(const SpectralSystem& system,
                                       std::span<const double> parameters,
                                       std::span<CurvePoint> curve) const {
  sum_filtered(*this, compacted_terms_of(system), parameters, curve);
}

void Tikhonov::Options::visit(OptionVisitor& visitor) {
  visitor("order", "order of the derivative whose norm is held down",
          {.range = Range::closed(0, 2)}, order);
}

Tikhonov::Tikhonov(const Options& options) : order_(options.order) {
  MODCAL_REQUIRE(order_ >= 0 && order_ <= 2, "order {} of the derivative: 0, 1 or 2", order_);
}

double Tikhonov::penalty(double omega, double reference) const {
  const double ratio = omega / reference;
  return order_ == 0 ? 1.0 : order_ == 1 ? ratio : ratio * ratio;
}

void WienerFilter::Options::visit(OptionVisitor& visitor) {
  visitor("corner", "frequency below which the supposed spectrum of the force is flat",
          {.unit = "Hz", .range = Range::positive()}, corner);
}

WienerFilter::WienerFilter(const Options& options)
    : corner_(2.0 * std::numbers::pi * options.corner) {
  MODCAL_REQUIRE(corner_ > 0.0 && std::isfinite(corner_), "corner {:g} Hz must be > 0",
                 options.corner);
}

double WienerFilter::penalty(double omega, double /*reference*/) const {
  return std::hypot(1.0, omega / corner_);
}

}  // namespace modcal
