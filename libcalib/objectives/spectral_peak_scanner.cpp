#include "libcalib/objectives/spectral_peak_scanner.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <numbers>

namespace modcal {
namespace {

void integrate_in_parallel(const CandidateBand& band, std::span<const double> omegas,
                           std::span<double> values) {
  // Below some microseconds of work a task costs more than it saves.
  constexpr std::size_t kTaskPoints = 4096;
  const std::size_t points = band.rest.bins * omegas.size();
  const std::size_t tasks = std::min(points / kTaskPoints, omegas.size());
  if (tasks < 2) {
    integrate_candidates(band, omegas, values);
    return;
  }
  tbb::parallel_for(std::size_t{0}, tasks, [&](std::size_t task) {
    const std::size_t begin = task * omegas.size() / tasks;
    const std::size_t count = (task + 1) * omegas.size() / tasks - begin;
    integrate_candidates(band, omegas.subspan(begin, count), values.subspan(begin, count));
  });
}

}  // namespace

SpectralPeakScanner::SpectralPeakScanner(const SpectralPeakFunction& function,
                                         std::span<const double> x)
    : EvaluatingScanner(function, x),
      function_(function),
      range_(function.reachable()),
      sums_(sums_storage_.view(range_)) {
  refresh();
}

void SpectralPeakScanner::refresh() {
  terms_ = two_sided_terms(function_.parameters().model(point()));
  add_up_terms_in_parallel(terms_, function_.grid().spacing, sums_);
}

CandidateBand SpectralPeakScanner::prepare_band(const TwoSidedTerm& term) {
  BinRange bins = function_.band_about(term.omega);
  bins.first = std::max(bins.first, range_.first);
  bins.last = std::max(bins.first, std::min(bins.last, range_.last));
  CandidateBand band{
      .rest = rest_storage_.view(bins), .term = term, .spacing = function_.grid().spacing};
  leave_out_term(term, band.spacing, sums_, band.rest);
  for (std::size_t r = 0; r < 2; ++r) {
    const std::vector<double>& all = function_.magnitudes()[r];
    if (all.empty()) continue;
    band_magnitudes_[r].assign(bins.size() + kBandLanes, 0.0);
    std::copy_n(all.begin() + static_cast<std::ptrdiff_t>(bins.first), bins.size(),
                band_magnitudes_[r].begin());
    band.magnitude[r] = band_magnitudes_[r].data();
  }
  return band;
}

void SpectralPeakScanner::scan(std::size_t i, std::span<const double> candidates,
                               std::span<double> values) {
  const Parameter& parameter = function_.parameters()[i];
  if (parameter.kind != ParameterKind::kFrequency) {
    EvaluatingScanner::scan(i, candidates, values);
    return;
  }
  const CandidateBand band = prepare_band(terms_[parameter.mode]);
  omegas_.assign(candidates.begin(), candidates.end());
  for (double& omega : omegas_) omega *= 2.0 * std::numbers::pi;
  integrate_in_parallel(band, omegas_, values);
}

void SpectralPeakScanner::move(std::size_t i, double value) {
  EvaluatingScanner::move(i, value);
  const Parameter& parameter = function_.parameters()[i];
  if (parameter.kind != ParameterKind::kFrequency) {
    refresh();
    return;
  }
  TwoSidedTerm& term = terms_[parameter.mode];
  const double omega = 2.0 * std::numbers::pi * value;
  if (omega == term.omega) return;
  move_term(term, omega, function_.grid().spacing, sums_);
  term.omega = omega;
}

}  // namespace modcal
