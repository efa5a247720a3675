#include "libcalib/objectives/spectral_peak_scanner.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <numbers>

namespace modcal {

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

void SpectralPeakScanner::scan(std::size_t i, std::span<const double> candidates,
                               std::span<double> values) {
  const Parameter& parameter = function_.parameters()[i];
  if (parameter.kind != ParameterKind::kFrequency) {
    EvaluatingScanner::scan(i, candidates, values);
    return;
  }
  const TwoSidedTerm& term = terms_[parameter.mode];
  BinRange band = function_.band_about(term.omega);
  band.first = std::max(band.first, range_.first);
  band.last = std::max(band.first, std::min(band.last, range_.last));
  CandidateBand work{
      .rest = rest_storage_.view(band), .term = term, .spacing = function_.grid().spacing};
  leave_out_term(term, work.spacing, sums_, work.rest);
  for (std::size_t r = 0; r < 2; ++r) {
    const std::vector<double>& all = function_.magnitudes()[r];
    if (all.empty()) continue;
    band_magnitudes_[r].assign(band.size() + kBandLanes, 0.0);
    std::copy_n(all.begin() + static_cast<std::ptrdiff_t>(band.first), band.size(),
                band_magnitudes_[r].begin());
    work.magnitude[r] = band_magnitudes_[r].data();
  }
  omegas_.assign(candidates.begin(), candidates.end());
  for (double& omega : omegas_) omega *= 2.0 * std::numbers::pi;
  // Below some microseconds of work a task costs more than it saves.
  constexpr std::size_t kTaskPoints = 4096;
  const std::size_t tasks =
      std::clamp<std::size_t>(band.size() * omegas_.size() / kTaskPoints, 1, omegas_.size());
  const std::span<const double> omegas(omegas_);
  const auto run = [&](std::size_t task) {
    const std::size_t begin = task * omegas.size() / tasks;
    const std::size_t end = (task + 1) * omegas.size() / tasks;
    integrate_candidates(work, omegas.subspan(begin, end - begin),
                         values.subspan(begin, end - begin));
  };
  if (tasks == 1) {
    run(0);
  } else {
    tbb::parallel_for(std::size_t{0}, tasks, run);
  }
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
