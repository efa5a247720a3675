#include "libcalib/objectives/two_sided_force.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "libcalib/objectives/two_sided_arrays.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

BinRange band_of(const FrequencyGrid& grid, const ModalBasis& basis,
                 const TwoSidedForceOptions& options) {
  const auto [low, high] = std::minmax_element(basis.omega.begin(), basis.omega.end());
  const double two_pi = 2.0 * std::numbers::pi;
  const double from = std::isnan(options.lowest) ? 0.5 * *low : two_pi * options.lowest;
  const double to = std::isnan(options.highest) ? 1.04 * *high : two_pi * options.highest;
  BinRange band = bins_between(grid, from, to);
  // The Nyquist bin holds only part of what a complex transfer function says.
  band.last = std::min(band.last, grid.bins - 1);
  MODCAL_REQUIRE(band.first < band.last,
                 "the band from {:g} to {:g} Hz holds no bin: bins are {:g} Hz apart",
                 from / two_pi, to / two_pi, grid.spacing / two_pi);
  return band;
}

}  // namespace

void TwoSidedForceOptions::visit(OptionVisitor& visitor) {
  visitor.plugin({.key = "regularizer", .meaning = "filter of the inversions that are compared"},
                 regularizer);
  visitor.number({.key = "parameter",
                  .meaning = "regularization parameter, in the unit of the transfer function",
                  .unit = "1",
                  .range = Range::non_negative()},
                 parameter);
  visitor.flag({.key = "common_filter",
                .meaning = "filter both forces alike, so that only the model makes a difference"},
               common_filter);
  visitor.number({.key = "lowest_frequency",
                  .meaning = "lower end of the band compared; automatic: half the lowest mode's",
                  .unit = "Hz",
                  .range = Range::non_negative(),
                  .word = "automatic"},
                 lowest);
  visitor.number(
      {.key = "highest_frequency",
       .meaning = "upper end of the band compared; automatic: 4 % above the highest mode",
       .unit = "Hz",
       .range = Range::positive(),
       .word = "automatic"},
      highest);
}

TwoSidedForce::TwoSidedForce(const CalibrationData& data, const ParameterSet& parameters,
                             const TwoSidedForceOptions& options)
    : parameters_(parameters),
      grid_(data.grid()),
      band_(band_of(grid_, parameters.initial().basis, options)),
      regularizer_(options.regularizer.make()),
      parameter_(options.parameter),
      common_filter_(options.common_filter) {
  MODCAL_REQUIRE(data.has_both(),
                 "this objective compares the forces identified from the two ends: the {} reaction "
                 "is missing",
                 data.has(End::kLeft) ? "right" : "left");
  MODCAL_REQUIRE(parameter_ >= 0.0 && std::isfinite(parameter_),
                 "regularization parameter {:g} must be finite and >= 0", parameter_);
  for (std::size_t r = 0; r < 2; ++r) {
    const auto begin = data.reactions[r].begin();
    reaction_[r].assign(begin + static_cast<std::ptrdiff_t>(band_.first),
                        begin + static_cast<std::ptrdiff_t>(band_.last));
  }
}

TwoSidedForce::State TwoSidedForce::at(std::span<const double> x, bool with_slopes) const {
  const ModelPoint point = parameters_.model(x);
  State state;
  state.x.assign(x.begin(), x.end());
  state.terms = two_sided_terms(point);
  if (with_slopes) state.contact_terms = contact_slope_terms(point);
  TwoSidedArrays storage;
  const TwoSidedSums sums = storage.view(band_);
  add_up_terms_in_parallel(state.terms, grid_.spacing, sums);
  for (std::size_t r = 0; r < 2; ++r) {
    state.transfer[r].resize(bins());
    for (std::size_t i = 0; i < bins(); ++i) {
      state.transfer[r][i] = {sums.real[r][i], sums.imag[r][i]};
    }
    filter(state, r, with_slopes);
  }
  identify(state);
  return state;
}

void TwoSidedForce::filter(State& state, std::size_t r, bool with_slopes) const {
  const std::size_t n = bins();
  std::vector<double> sigma(n);
  for (std::size_t i = 0; i < n; ++i) sigma[i] = std::abs(state.transfer[r][i]);
  state.kept[r].resize(n);
  regularizer_->filter_factors(sigma, parameter_, state.kept[r]);
  if (!with_slopes) return;
  constexpr double kStep = 1e-5;
  std::vector<double> shifted(n), above(n), below(n);
  std::transform(sigma.begin(), sigma.end(), shifted.begin(),
                 [](double s) { return s * (1.0 + kStep); });
  regularizer_->filter_factors(shifted, parameter_, above);
  std::transform(sigma.begin(), sigma.end(), shifted.begin(),
                 [](double s) { return s * (1.0 - kStep); });
  regularizer_->filter_factors(shifted, parameter_, below);
  state.kept_slope[r].resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double change = above[i] - below[i];
    // A jump by the whole of φ is a step of a water level, whose slope elsewhere is 0.
    const bool step = std::abs(change) > 0.5;
    state.kept_slope[r][i] = step || sigma[i] == 0.0 ? 0.0 : change / (2.0 * kStep * sigma[i]);
  }
}

void TwoSidedForce::identify(State& state) const {
  for (std::size_t r = 0; r < 2; ++r) {
    state.force[r].resize(bins());
    for (std::size_t k = 0; k < bins(); ++k) {
      const double kept = common_filter_ ? state.kept[0][k] * state.kept[1][k] : state.kept[r][k];
      // φ(0) = 0: what H does not pass is not identified.
      state.force[r][k] =
          kept == 0.0 ? Complex(0.0) : kept * reaction_[r][k] / state.transfer[r][k];
    }
  }
}

void TwoSidedForce::transfer_slope(const State& state, std::size_t i, Pair& slope) const {
  for (auto& values : slope) values.assign(bins(), 0.0);
  for (const auto& [mode, omega_slope] : parameters_.frequency_slopes(state.x, i)) {
    const TwoSidedTerm& term = state.terms[mode];
    for (std::size_t k = 0; k < bins(); ++k) {
      const Complex change = omega_slope * term.inverse_slope(grid_.omega(band_.first + k));
      slope[0][k] += term.residue[0] * change;
      slope[1][k] += term.residue[1] * change;
    }
  }
  if (parameters_[i].kind != ParameterKind::kContact) return;
  TwoSidedArrays storage;
  const TwoSidedSums sums = storage.view(band_);
  add_up_terms_in_parallel(state.contact_terms, grid_.spacing, sums);
  for (std::size_t r = 0; r < 2; ++r) {
    for (std::size_t k = 0; k < bins(); ++k) slope[r][k] = {sums.real[r][k], sums.imag[r][k]};
  }
}

// dF_r = R_r (dΦ_r/H_r − Φ_r dH_r/H_r²) with dφ(|H|) = dφ/d|H| Re(H* dH)/|H|.
void TwoSidedForce::force_slope(const State& state, std::size_t i, Pair& slope) const {
  assert(!state.kept_slope[0].empty());
  transfer_slope(state, i, slope);
  for (std::size_t k = 0; k < bins(); ++k) {
    std::array<double, 2> change;
    for (std::size_t r = 0; r < 2; ++r) {
      const Complex h = state.transfer[r][k];
      const double sigma = std::abs(h);
      const double sigma_slope = sigma > 0.0 ? (std::conj(h) * slope[r][k]).real() / sigma : 0.0;
      change[r] = state.kept_slope[r][k] * sigma_slope;
    }
    const double left = state.kept[0][k];
    const double right = state.kept[1][k];
    const double common_change = left * change[1] + right * change[0];
    for (std::size_t r = 0; r < 2; ++r) {
      const double kept = common_filter_ ? left * right : state.kept[r][k];
      const double kept_change = common_filter_ ? common_change : change[r];
      const Complex h = state.transfer[r][k];
      slope[r][k] =
          kept == 0.0 ? Complex(0.0) : reaction_[r][k] / h * (kept_change - kept * slope[r][k] / h);
    }
  }
}

}  // namespace modcal
