// Causes of misfit that are made of the force of a fit.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcalib/identifiability/fitted_record.hpp"
#include "libcalib/identifiability/tuning.hpp"

namespace modcal {

using std::numbers::pi;

namespace {

// 0 below 0, 1 above 1, smooth between.
double raised_cosine(double x) { return 0.5 - 0.5 * std::cos(pi * std::clamp(x, 0.0, 1.0)); }

}  // namespace

MisfitCause FittedRecord::modes_above() const {
  MisfitCause cause{.name = std::string(kModesAbove)};
  const double top = record_.omega[record_.bins - 1];
  for (const bool right : {false, true}) {
    for (const int power : {0, 2}) {
      PlanarVector change = numbers();
      for (std::size_t k = 0; k < record_.bins; ++k) {
        change.set(k, std::pow(record_.omega[k] / top, power) * force_[k]);
      }
      cause.columns.push_back(right ? SignalColumn{{}, std::move(change)}
                                    : SignalColumn{std::move(change), {}});
    }
  }
  return cause;
}

MisfitCause FittedRecord::moving_contact() const {
  Motions slope(record_.bins);  // ∂H_r/∂x_c
  std::vector<Complex> receptance(record_.bins);
  for (const LikelihoodMode& mode : modes_) {
    for (std::size_t k = 0; k < record_.bins; ++k) {
      receptance[k] = mode.residue_slope * inverse_denominator(mode, {0.0, record_.omega[k]});
    }
    slope.add(receptance, mode.even);
  }
  MisfitCause cause{.name = std::string(kContact)};
  // What force and decays of the fit are apart stands at the ends of the record, but for what the
  // edges of the band smear over it: where edges and ends are smooth nothing of it is left.
  const double rise = kEdgeWidth * std::sqrt(modes_[0].omega_squared);  // [rad/s]
  const double low = record_.omega[0], high = record_.omega[record_.bins - 1];
  const double duration = 2.0 * pi / record_.spacing;
  std::vector<Complex> inner(record_.bins);
  for (std::size_t k = 0; k < record_.bins; ++k) {
    const double omega = record_.omega[k];
    inner[k] =
        force_[k] * raised_cosine((omega - low) / rise) * raised_cosine((high - omega) / rise);
  }
  const double quiet = kQuietEnds * 2.0 * pi / (rise * duration);
  const auto add = [&](auto factor) {
    const std::vector<Complex> force = modulated(inner, [&](double share) {
      return factor(share) * raised_cosine(std::min(share, 1.0 - share) / quiet - 1.0);
    });
    SignalColumn column{numbers(), numbers()};
    for (std::size_t k = 0; k < record_.bins; ++k) {
      const NoisePair both = ends(slope, k);
      column.left.set(k, both.left * force[k]);
      column.right.set(k, both.right * force[k]);
    }
    cause.columns.push_back(std::move(column));
  };
  const double most = std::clamp(std::round(2.0 * kFastestContact * duration), 2.0, kMostCosines);
  for (int half_periods = 1; half_periods <= static_cast<int>(most); ++half_periods) {
    add([=](double share) { return std::cos(pi * half_periods * share); });
  }
  return cause;
}

}  // namespace modcal
