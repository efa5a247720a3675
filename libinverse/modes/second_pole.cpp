#include "libinverse/modes/second_pole.hpp"

#include <cmath>

namespace modcal {

DecayRecord alone(const DampedSinusoidFit& fit, const std::vector<std::size_t>& modes,
                  double sample_rate) {
  DecayRecord record{.sample_rate = sample_rate, .channels = fit.residual};
  for (const std::size_t k : modes) {
    const std::complex<double> exponent = fit.modes[k].pole.exponent();
    for (std::size_t m = 0; m < record.samples(); ++m) {
      const std::complex<double> moved =
          std::exp(exponent * (static_cast<double>(m) / sample_rate));
      for (std::size_t c = 0; c < record.channels.size(); ++c) {
        record.channels[c][m] += (fit.modes[k].amplitude[c] * moved).real();
      }
    }
  }
  return record;
}

SecondPole fit_one_more(const DampedSinusoidFit& fit, std::size_t mode, double sample_rate,
                        double reach, double least, const DampedSinusoidOptions& options,
                        const std::optional<DecayPole>& stated) {
  SecondPole best;
  std::vector<DecayPole> start;
  for (std::size_t k = 0; k < fit.modes.size(); ++k) {
    const DecayPole& pole = fit.modes[k].pole;
    if (!(std::abs(pole.frequency - fit.modes[mode].pole.frequency) < reach)) continue;
    best.replaced.push_back(k);
    start.push_back(startable(pole, sample_rate));
  }
  const DecayRecord record = alone(fit, best.replaced, sample_rate);
  const std::complex<double> whole = startable(fit.modes[mode].pole, sample_rate).exponent();
  const double width = -whole.real() + sample_rate / static_cast<double>(record.samples());
  std::vector<DecayPole> places;
  if (stated) places.push_back(*stated);
  for (const std::complex<double> apart : {std::complex<double>(0.0, width),
                                           {0.0, -width},
                                           {-width, 0.0},
                                           {-0.5 * whole.real(), 0.0}}) {
    places.push_back(DecayPole::of_exponent(whole + apart));
  }
  start.emplace_back();
  for (const DecayPole& place : places) {
    start.back() = startable(place, sample_rate);
    const DampedSinusoidFit more = fit_damped_sinusoids(record, start, options);
    best.work += work_of(more);
    const double fall = chi_square_rise(more, fit, options.in_band_variance);
    if (!more.converged || !more.full_rank || !(fall > least)) continue;
    least = fall;
    best.poles.clear();
    for (const DecayMode& found : more.modes) {
      best.poles.push_back(startable(found.pole, sample_rate));
    }
  }
  return best;
}

}  // namespace modcal
