#include "libcalib/objectives/spectral_peak_function.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcalib/objectives/spectral_peak_scanner.hpp"
#include "libcalib/objectives/two_sided_arrays.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// Modes whose integral is in the value: those with a free frequency; all, where there is none.
std::vector<std::size_t> integrated_modes(const ParameterSet& parameters) {
  std::vector<std::size_t> modes;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    for (const auto& slope : parameters.frequency_slopes(parameters.start(), i)) {
      modes.push_back(slope.mode);
    }
  }
  std::sort(modes.begin(), modes.end());
  modes.erase(std::unique(modes.begin(), modes.end()), modes.end());
  if (!modes.empty()) return modes;
  for (std::size_t n = 0; n < parameters.initial().basis.size(); ++n) modes.push_back(n);
  return modes;
}

}  // namespace

SpectralPeakFunction::SpectralPeakFunction(const CalibrationData& data,
                                           const ParameterSet& parameters, double half_band)
    : parameters_(parameters), grid_(data.grid()), half_band_(half_band) {
  for (std::size_t r = 0; r < 2; ++r) {
    for (const Complex& value : data.reactions[r]) {
      magnitudes_[r].push_back(std::abs(value) * grid_.spacing / data.sample_rate);
    }
  }
  const ModelPoint start = parameters_.model(parameters_.start());
  const std::vector<std::size_t> modes = integrated_modes(parameters_);
  covered_ = band_about(start.basis.omega[modes.front()]);
  for (const std::size_t n : modes) {
    const BinRange band = band_about(start.basis.omega[n]);
    MODCAL_REQUIRE(
        band.size() > 0,
        "no bin lies within {:g} % of mode {} at {:g} Hz: bins are {:g} Hz apart; take a "
        "longer record or a wider band",
        100.0 * half_band_, n + 1, start.basis.frequency(n),
        grid_.spacing / (2.0 * std::numbers::pi));
    covered_.first = std::min(covered_.first, band.first);
    covered_.last = std::max(covered_.last, band.last);
  }
  count_.assign(covered_.size(), 0.0);
  for (const std::size_t n : modes) {
    const BinRange band = band_about(start.basis.omega[n]);
    for (std::size_t k = band.first; k < band.last; ++k) count_[k - covered_.first] += 1.0;
  }
}

BinRange SpectralPeakFunction::band_about(double omega) const {
  return bins_between(grid_, omega * (1.0 - half_band_), omega * (1.0 + half_band_));
}

std::unique_ptr<CoordinateScanner> SpectralPeakFunction::scanner(std::span<const double> x) const {
  return std::make_unique<SpectralPeakScanner>(*this, x);
}

// With F = R/H, ∂|F|/∂θ = −Re(|F|/H ∂H/∂θ): the weights are |F|/H times the number of bands.
void SpectralPeakFunction::do_evaluate(std::span<const double> x,
                                       const ObjectiveOutputs& outputs) const {
  const ModelPoint point = parameters_.model(x);
  const std::vector<TwoSidedTerm> terms = two_sided_terms(point);
  TwoSidedArrays storage;
  const TwoSidedSums sums = storage.view(covered_);
  add_up_terms_in_parallel(terms, grid_.spacing, sums);
  std::array<std::vector<Complex>, 2> weights;
  double value = 0.0;
  for (std::size_t r = 0; r < 2; ++r) {
    if (magnitudes_[r].empty()) continue;
    if (outputs.gradient) weights[r].resize(covered_.size());
    for (std::size_t i = 0; i < covered_.size(); ++i) {
      if (count_[i] == 0.0) continue;
      const Complex transfer{sums.real[r][i], sums.imag[r][i]};
      const double force =
          count_[i] * magnitudes_[r][covered_.first + i] / std::sqrt(std::norm(transfer));
      value += force;
      if (outputs.gradient) weights[r][i] = force / transfer;
    }
  }
  if (outputs.value) *outputs.value = value;
  if (outputs.gradient) fill_gradient(x, point, weights, outputs.gradient);
}

void SpectralPeakFunction::fill_gradient(std::span<const double> x, const ModelPoint& point,
                                         const std::array<std::vector<Complex>, 2>& weights,
                                         double* gradient) const {
  const std::vector<TwoSidedTerm> terms = two_sided_terms(point);
  const std::vector<TwoSidedTerm> contact_terms = contact_slope_terms(point);
  // Σ_k Re(z_n(ω_k) Σ_r a_r weight_rk) for one mode.
  const auto gather = [&](const TwoSidedTerm& term, bool by_frequency) {
    double sum = 0.0;
    for (std::size_t i = 0; i < covered_.size(); ++i) {
      if (count_[i] == 0.0) continue;
      const double omega = grid_.omega(covered_.first + i);
      Complex weight = 0.0;
      for (std::size_t r = 0; r < 2; ++r) {
        if (!weights[r].empty()) weight += term.residue[r] * weights[r][i];
      }
      const Complex slope =
          by_frequency ? term.inverse_slope(omega) : 1.0 / term.denominator(omega);
      sum += (slope * weight).real();
    }
    return sum;
  };
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    gradient[i] = 0.0;
    for (const auto& [mode, slope] : parameters_.frequency_slopes(x, i)) {
      gradient[i] -= slope * gather(terms[mode], true);
    }
    if (parameters_[i].kind != ParameterKind::kContact) continue;
    for (const TwoSidedTerm& term : contact_terms) gradient[i] -= gather(term, false);
  }
}

}  // namespace modcal
