#include "libinverse/modes/significant_fit.hpp"

#include <algorithm>
#include <cmath>

namespace modcal {
namespace {

// Poles of a fit but those of `out`. What does not decay cannot start a fit: it begins beside.
std::vector<DecayPole> poles_without(const DampedSinusoidFit& fit, const std::vector<bool>& out,
                                     double rate) {
  std::vector<DecayPole> poles;
  for (std::size_t k = 0; k < fit.modes.size(); ++k) {
    if (out[k]) continue;
    DecayPole pole = fit.modes[k].pole;
    pole.damping_ratio = std::clamp(pole.damping_ratio, 1e-6, 0.5);
    pole.frequency = std::clamp(pole.frequency, 1e-6 * rate, (0.5 - 1e-6) * rate);
    poles.push_back(pole);
  }
  return poles;
}

// Of χ² from one fit to another, the noise that of the first.
double rise(const DampedSinusoidFit& from, const DampedSinusoidFit& to, std::size_t samples,
            double in_band_variance) {
  double sum = 0.0;
  for (std::size_t c = 0; c < from.squares.size(); ++c) {
    sum += static_cast<double>(samples) * (to.squares[c] / from.squares[c] - 1.0);
  }
  return sum / in_band_variance;
}

// Those next to one of more evidence, the least first.
std::vector<std::size_t> neighbors(const DampedSinusoidFit& fit, double reach) {
  std::vector<std::size_t> found;
  for (std::size_t k = 0; k < fit.modes.size(); ++k) {
    for (std::size_t i = 0; i < fit.modes.size(); ++i) {
      const double apart = fit.modes[i].pole.frequency - fit.modes[k].pole.frequency;
      if (!(std::abs(apart) < reach) || !(fit.evidence[i] > fit.evidence[k])) continue;
      found.push_back(k);
      break;
    }
  }
  std::ranges::sort(found, {}, [&](std::size_t k) { return fit.evidence[k]; });
  return found;
}

}  // namespace

double largest_by_chance(std::size_t places, std::size_t degrees) {
  const double allowed = 1e-3 / static_cast<double>(places);
  for (double half = 1.0;; half += 0.25) {
    // P(χ² > x) = exp(−x/2) Σ (x/2)^i/i!
    double term = std::exp(-half), sum = 0.0;
    for (std::size_t i = 0; 2 * i < degrees; ++i) {
      sum += term;
      term *= half / static_cast<double>(i + 1);
    }
    if (sum < allowed) return 2.0 * half;
  }
}

DampedSinusoidFit fit_significant(const DecayRecord& record, std::vector<DecayPole> start,
                                  double reach, const DampedSinusoidOptions& options) {
  const std::size_t amplitudes = 2 * record.channels.size();
  const double least = largest_by_chance(record.samples(), amplitudes);
  const double least_with_pole = largest_by_chance(record.samples(), amplitudes + 2);
  DampedSinusoidFit fit = fit_damped_sinusoids(record, start, options);
  const auto without = [&](const std::vector<bool>& out) {
    start = poles_without(fit, out, record.sample_rate);
    return start.empty() ? DampedSinusoidFit() : fit_damped_sinusoids(record, start, options);
  };
  for (bool changed = true; changed;) {
    changed = false;
    std::vector<bool> out(fit.modes.size());
    for (std::size_t k = 0; k < out.size(); ++k) out[k] = fit.evidence[k] < least;
    if (std::ranges::find(out, true) != out.end()) {
      fit = without(out);
      changed = true;
      continue;
    }
    for (const std::size_t k : neighbors(fit, reach)) {
      std::vector<bool> one(fit.modes.size());
      one[k] = true;
      DampedSinusoidFit next = without(one);
      const double by = rise(fit, next, record.samples(), options.in_band_variance);
      if (!next.converged || !(by < least_with_pole)) continue;
      fit = std::move(next);
      changed = true;
      break;
    }
  }
  return fit;
}

}  // namespace modcal
