#include "libcalib/objectives/peak_bands.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// Those with a free frequency; all, where there is none.
std::set<std::size_t> integrated_modes(const ParameterSet& parameters) {
  std::set<std::size_t> modes;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    for (const auto& slope : parameters.frequency_slopes(parameters.start(), i)) {
      modes.insert(slope.mode);
    }
  }
  if (!modes.empty()) return modes;
  for (std::size_t n = 0; n < parameters.initial().basis.size(); ++n) modes.insert(n);
  return modes;
}

}  // namespace

PeakBands::PeakBands(const CalibrationData& data, const ParameterSet& parameters, double half_band)
    : parameters_(parameters),
      half_band_(half_band),
      scale_(data.grid().spacing / data.sample_rate),
      kernel_({.grid = data.grid()}, {}) {
  for (std::size_t r = 0; r < 2; ++r) {
    for (const Complex& value : data.reactions[r]) {
      magnitudes_[r].push_back(std::abs(value) * grid().spacing / data.sample_rate);
    }
  }
  const ModalBasis basis = parameters_.model(parameters_.start()).basis;
  std::vector<BinRange> bands;
  for (const std::size_t n : integrated_modes(parameters_)) {
    bands.push_back(band_about(basis.omega[n]));
    MODCAL_REQUIRE(
        bands.back().size() > 0,
        "no bin lies within {:g} % of mode {} at {:g} Hz: bins are {:g} Hz apart; take a "
        "longer record or a wider band",
        100.0 * half_band_, n + 1, basis.frequency(n), grid().spacing / (2.0 * std::numbers::pi));
  }
  BinRange covered = bands.front();
  for (const BinRange& band : bands) {
    covered.first = std::min(covered.first, band.first);
    covered.last = std::max(covered.last, band.last);
  }
  count_.assign(covered.size(), 0.0);
  for (const BinRange& band : bands) {
    for (std::size_t k = band.first; k < band.last; ++k) count_[k - covered.first] += 1.0;
  }
  kernel_ = ForceKernel(band_of(data, covered), {});
}

BinRange PeakBands::band_about(double omega) const {
  return bins_between(grid(), omega * (1.0 - half_band_), omega * (1.0 + half_band_));
}

}  // namespace modcal
