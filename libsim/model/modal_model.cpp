#include "libsim/model/modal_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libsim/base/error.hpp"
#include "libsim/base/task_loop.hpp"
#include "libsim/model/modal_kernel.hpp"

namespace modcal {
namespace {

// Turns Σ Re A/D and Σ Im A …/D of a pair into H.
Complex completed(Complex sum, Complex turned, int power, const ResidualTerms& residual,
                  Complex s) {
  if (s == 0.0) return power == 0 ? sum + residual.at(s) : 0.0;
  sum += turned * (power == 0 ? s : 1.0 / s) + residual.at(s);
  return power == 0 ? sum : power == 1 ? sum * s : sum * s * s;
}

}  // namespace

FrequencyGrid FrequencyGrid::of_record(std::size_t samples, double sample_rate) {
  MODCAL_REQUIRE(samples >= 1 && sample_rate > 0.0,
                 "a record of {} samples at {:g} Hz has no frequency grid", samples, sample_rate);
  return {.spacing = 2.0 * std::numbers::pi * sample_rate / static_cast<double>(samples),
          .bins = samples / 2 + 1,
          .sigma = 0.0};
}

BinRange bins_between(const FrequencyGrid& grid, double low, double high) {
  const double top = static_cast<double>(grid.bins);
  const auto first =
      static_cast<std::size_t>(std::clamp(std::ceil(low / grid.spacing), 1.0, std::max(top, 1.0)));
  const auto last = static_cast<std::size_t>(
      std::clamp(std::floor(high / grid.spacing) + 1.0, 1.0, std::max(top, 1.0)));
  return {first, std::max(first, last)};
}

int power_of_s(SensorKind kind) {
  return kind == SensorKind::kVelocity ? 1 : kind == SensorKind::kAcceleration ? 2 : 0;
}

Complex ResidualTerms::at(Complex s) const {
  Complex value = constant + above * s * s;
  if (below != 0.0) value += below / (s * s);
  return value;
}

void SplitSpectra::resize(std::size_t spectra, std::size_t bins) {
  bins_ = bins;
  stride_ = (bins + kBinLanes - 1) / kBinLanes * kBinLanes;
  if (values_.size() < 2 * spectra * stride_) values_.resize(2 * spectra * stride_);
}

std::vector<Complex> SplitSpectra::joined(std::size_t i) const {
  std::vector<Complex> values(bins_);
  for (std::size_t k = 0; k < bins_; ++k) values[k] = at(i, k);
  return values;
}

ModalModel ModalModel::with_sensors(const std::vector<std::size_t>& chosen) const {
  ModalModel model{.poles = poles, .sensors = {}, .contacts = contacts};
  const auto append = [this](const auto& from, std::size_t sensor, std::size_t width, auto& to) {
    if (from.empty()) return;
    const auto begin = from.begin() + static_cast<std::ptrdiff_t>(sensor * contacts * width);
    to.insert(to.end(), begin, begin + static_cast<std::ptrdiff_t>(contacts * width));
  };
  for (const std::size_t sensor : chosen) {
    model.sensors.push_back(sensors[sensor]);
    append(constants, sensor, poles.size(), model.constants);
    append(quadrature, sensor, poles.size(), model.quadrature);
    append(residuals, sensor, 1, model.residuals);
  }
  return model;
}

ModalSums::ModalSums(const ModalModel& model) : model_(model) {
  const std::size_t modes = model.poles.size(), pairs = model.pairs();
  const bool real = model.quadrature.empty();
  rows_.resize(real ? pairs : 2 * pairs);
  for (std::size_t n = 0; n < modes; ++n) {
    bool driven = false;
    for (std::size_t i = 0; i < pairs; ++i) {
      driven = driven || model.constant(i, n) != 0.0 ||
               (!real && model.quadrature[i * modes + n] != 0.0);
    }
    if (!driven) continue;
    const ModalPole& pole = model.poles[n];
    poles_.push_back(pole);
    for (std::size_t i = 0; i < pairs; ++i) {
      rows_[i].push_back(model.constant(i, n));
      if (real) continue;
      const double turned = model.quadrature[i * modes + n];
      const bool displaced = power_of_s(model.sensors[i / model.contacts]) == 0;
      rows_[pairs + i].push_back(displaced ? turned / pole.omega : -turned * pole.omega);
    }
  }
}

void ModalSums::evaluate(const FrequencyGrid& grid, const BinRange& part, std::size_t begin,
                         SplitSpectra& out) const {
  std::vector<ModalSum> sums;
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    sums.push_back({rows_[i].data(), out.real(i) + begin, out.imag(i) + begin});
  }
  add_up_modes(poles_, sums, grid, part);
  const std::size_t pairs = model_.pairs();
  const bool real = model_.quadrature.empty();
  for (std::size_t i = 0; i < pairs; ++i) {
    const int power = power_of_s(model_.sensors[i / model_.contacts]);
    if (power == 0 && real && model_.residuals.empty()) continue;
    const ResidualTerms residual = model_.residuals.empty() ? ResidualTerms{} : model_.residuals[i];
    for (std::size_t j = 0; j < part.size(); ++j) {
      const Complex turned = real ? Complex{} : out.at(pairs + i, begin + j);
      const Complex value =
          completed(out.at(i, begin + j), turned, power, residual, grid.s(part.first + j));
      out.real(i)[begin + j] = value.real();
      out.imag(i)[begin + j] = value.imag();
    }
  }
}

void ModalModel::evaluate(const FrequencyGrid& grid, const BinRange& bins,
                          SplitSpectra& out) const {
  const ModalSums sums(*this);
  out.resize(sums.rows(), bins.size());
  sums.evaluate(grid, bins, 0, out);
}

void ModalModel::evaluate_in_parallel(const FrequencyGrid& grid, const BinRange& bins,
                                      SplitSpectra& out) const {
  // About 100 µs of work for 50 modes; a multiple of kBinLanes.
  // Fixed by: work of a task; every bin is the same whatever its block.
  constexpr std::size_t kBlock = 1024;
  const ModalSums sums(*this);
  out.resize(sums.rows(), bins.size());
  for_each_task((bins.size() + kBlock - 1) / kBlock, [&](std::size_t block) {
    const std::size_t begin = block * kBlock, first = bins.first + begin;
    sums.evaluate(grid, {first, std::min(bins.last, first + kBlock)}, begin, out);
  });
}

std::vector<std::vector<Complex>> ModalModel::transfer(const FrequencyGrid& grid) const {
  SplitSpectra sums;
  evaluate(grid, {0, grid.bins}, sums);
  std::vector<std::vector<Complex>> result;
  for (std::size_t i = 0; i < pairs(); ++i) result.push_back(sums.joined(i));
  return result;
}

void ModalModel::pole_slopes(std::size_t n, Complex s, double d_omega, double d_zeta,
                             std::span<Complex> slopes) const {
  const ModalPole& pole = poles[n];
  Complex slope = 0.0;
  if (d_omega != 0.0) slope += d_omega * pole.slope_by_omega(s);
  if (d_zeta != 0.0) slope += d_zeta * pole.slope_by_zeta(s);
  for (std::size_t i = 0; i < pairs(); ++i) {
    const int power = power_of_s(sensors[i / contacts]);
    slopes[i] = constant(i, n) * slope;
    if (!quadrature.empty()) {
      // Im A q/D with q = s/ω_n or −ω_n/s: q moves with the pole as well.
      const Complex q = power == 0 ? s / pole.omega : -pole.omega / s;
      const Complex q_slope = (power == 0 ? -1.0 : 1.0) * q / pole.omega * d_omega;
      slopes[i] += quadrature[i * poles.size() + n] * (q * slope + q_slope / pole.denominator(s));
    }
    for (int p = 0; p < power; ++p) slopes[i] *= s;
  }
}

}  // namespace modcal
