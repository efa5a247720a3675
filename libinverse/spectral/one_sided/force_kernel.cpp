#include "libinverse/spectral/one_sided/force_kernel.hpp"

#include <cassert>
#include <cmath>

#include "libinverse/spectral/one_sided/tuning.hpp"

namespace modcal {

void identify_force(std::span<const double> kept, std::span<const Complex> inverse,
                    std::span<Complex> force) {
  for (std::size_t k = 0; k < force.size(); ++k) force[k] *= kept[k] * inverse[k];
}

ForceKernel::State ForceKernel::at(const ModalModel& model, bool with_slopes) const {
  SplitSpectra sums;
  model.evaluate_in_parallel(record_.grid, record_.bins, sums);
  const std::size_t sensors = record_.spectra.size(), bins = record_.bins.size();
  State state;
  state.kept.resize(sensors);
  state.kept_slope.resize(with_slopes ? sensors : 0);
  for (std::size_t r = 0; r < sensors; ++r) {
    state.transfer.push_back(sums.joined(r));
    std::vector<Complex>& inverse = state.inverse.emplace_back(bins);
    for (std::size_t k = 0; k < bins; ++k) {
      const Complex h = state.transfer[r][k];
      inverse[k] = h == 0.0 ? Complex(0.0) : 1.0 / h;
    }
    fill_filter(state, r, with_slopes);
  }
  std::vector<double> kept(bins);
  for (std::size_t r = 0; r < sensors; ++r) {
    std::vector<Complex>& force = state.force.emplace_back(record_.spectra[r]);
    for (std::size_t k = 0; k < bins; ++k) kept[k] = filter_at(state, r, k);
    identify_force(kept, state.inverse[r], force);
  }
  return state;
}

void ForceKernel::fill_filter(State& state, std::size_t sensor, bool with_slopes) const {
  const std::size_t bins = record_.bins.size();
  std::vector<double>& kept = state.kept[sensor];
  kept.assign(bins, 1.0);
  if (with_slopes) state.kept_slope[sensor].assign(bins, 0.0);
  if (!filter_.regularizer) return;
  std::vector<double> sigma(bins), shifted(bins);
  for (std::size_t k = 0; k < bins; ++k) sigma[k] = std::abs(state.transfer[sensor][k]);
  filter_.regularizer->filter_factors(sigma, filter_.parameter, kept);
  if (!with_slopes) return;
  const auto factors_at = [&](double scale) {
    std::vector<double> factors(bins);
    for (std::size_t k = 0; k < bins; ++k) shifted[k] = sigma[k] * scale;
    filter_.regularizer->filter_factors(shifted, filter_.parameter, factors);
    return factors;
  };
  const std::vector<double> above = factors_at(1.0 + kScaleStep),
                            below = factors_at(1.0 - kScaleStep);
  for (std::size_t k = 0; k < bins; ++k) {
    const double change = above[k] - below[k];
    // A jump by the whole of φ is a step of a water level, whose slope elsewhere is 0.
    const bool step = std::abs(change) > 0.5;
    if (!step && sigma[k] > 0.0) {
      state.kept_slope[sensor][k] = change / (2.0 * kScaleStep * sigma[k]);
    }
  }
}

double ForceKernel::filter_at(const State& state, std::size_t sensor, std::size_t k) const {
  if (!filter_.common) return state.kept[sensor][k];
  double kept = 1.0;
  for (const auto& of_sensor : state.kept) kept *= of_sensor[k];
  return kept;
}

// dF = R (dΦ/H − Φ dH/H²) with dφ(|H|) = dφ/d|H| Re(H* dH)/|H|.
void ForceKernel::force_slope(const State& state, SensorSpectra& slope) const {
  assert(!state.kept_slope.empty());
  const std::size_t sensors = record_.spectra.size();
  std::vector<double> change(sensors);  // dφ of every sensor
  for (std::size_t k = 0; k < record_.bins.size(); ++k) {
    for (std::size_t r = 0; r < sensors; ++r) {
      const Complex h = state.transfer[r][k];
      const double sigma = std::abs(h);
      const double sigma_slope = sigma > 0.0 ? (std::conj(h) * slope[r][k]).real() / sigma : 0.0;
      change[r] = state.kept_slope[r][k] * sigma_slope;
    }
    double common_change = 0.0;
    for (std::size_t r = 0; filter_.common && r < sensors; ++r) {
      double product = change[r];
      for (std::size_t q = 0; q < sensors; ++q) {
        if (q != r) product *= state.kept[q][k];
      }
      common_change += product;
    }
    for (std::size_t r = 0; r < sensors; ++r) {
      const double kept = filter_at(state, r, k);
      const double kept_change = filter_.common ? common_change : change[r];
      const Complex inverse = state.inverse[r][k];
      // φ(0) = 0: what H does not pass is not identified.
      slope[r][k] = kept == 0.0 ? Complex(0.0)
                                : record_.spectra[r][k] * inverse *
                                      (kept_change - kept * slope[r][k] * inverse);
    }
  }
}

}  // namespace modcal
