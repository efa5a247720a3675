#include "libcalib/objectives/spectral_peak_scanner.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace modcal {
namespace {

// Bins of a task, some ten microseconds of work for 50 modes and 50 candidates; a multiple of
// kBandLanes.
constexpr std::size_t kBlock = 96;

std::size_t blocks_of(const CandidateBand& band) { return (band.rest.bins + kBlock - 1) / kBlock; }

}  // namespace

SpectralPeakScanner::SpectralPeakScanner(const SpectralPeakFunction& function,
                                         std::span<const double> x)
    : EvaluatingScanner(function, x), function_(function) {
  refresh();
}

void SpectralPeakScanner::refresh() {
  terms_ = two_sided_terms(function_.parameters().model(point()));
}

CandidateBand SpectralPeakScanner::prepare_band(std::size_t mode) {
  const TwoSidedTerm& term = terms_[mode];
  const BinRange bins = function_.band_about(term.omega);
  const std::size_t padded = (bins.size() + kBandLanes - 1) / kBandLanes * kBandLanes;
  CandidateBand band{.rest = rest_storage_.view({bins.first, bins.first + padded}), .term = term};
  for (std::size_t r = 0; r < 2; ++r) {
    const std::vector<double>& all = function_.magnitudes()[r];
    if (all.empty()) continue;
    magnitudes_[r].assign(padded, 0.0);
    std::copy_n(all.begin() + static_cast<std::ptrdiff_t>(bins.first), bins.size(),
                magnitudes_[r].begin());
    band.magnitude[r] = magnitudes_[r].data();
  }
  others_.assign(terms_.begin(), terms_.end());
  others_.erase(others_.begin() + static_cast<std::ptrdiff_t>(mode));
  band_omegas_.resize(padded);
  for (std::size_t k = 0; k < padded; ++k) {
    band_omegas_[k] = function_.grid().omega(bins.first + k);
  }
  band.omega = band_omegas_.data();
  return band;
}

void SpectralPeakScanner::integrate_block(const CandidateBand& band, std::size_t block) {
  const std::size_t begin = block * kBlock;
  CandidateBand part = band;
  part.rest.first_bin += begin;
  part.rest.bins = std::min(kBlock, band.rest.bins - begin);
  for (std::size_t r = 0; r < 2; ++r) {
    part.rest.real[r] += begin;
    part.rest.imag[r] += begin;
    if (band.magnitude[r]) part.magnitude[r] += begin;
  }
  part.omega += begin;
  add_up_terms(others_, function_.grid().spacing, part.rest);
  integrate_candidates(part, omegas_,
                       std::span(partial_).subspan(block * omegas_.size(), omegas_.size()));
}

void SpectralPeakScanner::scan(std::size_t i, std::span<const double> candidates,
                               std::span<double> values) {
  const Parameter& parameter = function_.parameters()[i];
  if (parameter.kind != ParameterKind::kFrequency) {
    EvaluatingScanner::scan(i, candidates, values);
    return;
  }
  const CandidateBand band = prepare_band(parameter.mode);
  omegas_.assign(candidates.begin(), candidates.end());
  for (double& omega : omegas_) omega *= 2.0 * std::numbers::pi;
  const std::size_t blocks = blocks_of(band);
  partial_.resize(blocks * candidates.size());
  if (blocks < 2) {
    if (blocks == 1) integrate_block(band, 0);
  } else {
    tbb::parallel_for(std::size_t{0}, blocks,
                      [&](std::size_t block) { integrate_block(band, block); });
  }
  std::fill(values.begin(), values.end(), 0.0);
  for (std::size_t j = 0; j < partial_.size(); ++j) values[j % candidates.size()] += partial_[j];
}

bool SpectralPeakScanner::reaches(std::size_t j, std::size_t i) const {
  const Parameter& from = function_.parameters()[j];
  const Parameter& to = function_.parameters()[i];
  if (from.kind != ParameterKind::kFrequency || to.kind != ParameterKind::kFrequency) return true;
  const double center = terms_[to.mode].omega;
  return std::abs(terms_[from.mode].omega - center) <= 2.0 * function_.half_band() * center;
}

void SpectralPeakScanner::move(std::size_t i, double value) {
  EvaluatingScanner::move(i, value);
  const Parameter& parameter = function_.parameters()[i];
  if (parameter.kind == ParameterKind::kFrequency) {
    terms_[parameter.mode].omega = 2.0 * std::numbers::pi * value;
  } else {
    refresh();
  }
}

}  // namespace modcal
