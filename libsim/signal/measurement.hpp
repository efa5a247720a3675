// What a sensor and its recorder make of a signal.
#pragma once

#include "libsim/base/options.hpp"
#include "libsim/base/random.hpp"
#include "libsim/signal/signal.hpp"

namespace modcal {

struct Measurement {
  double sample_rate = 51200.0;  ///< f_s [Hz]; noise is drawn at this rate
  double noise_level = 0.0;      ///< standard deviation of the noise over that of the signal [1]
  bool remove_mean = true;       ///< piezoelectric sensors give no static level
  void visit(OptionVisitor& visitor);
};

/// The signal as measured: white Gaussian noise with standard deviation noise_level·std(signal)
/// drawn from `key`, then the mean removed where asked for (Debut, Delaune and Antunes, 2010,
/// sections 2.3 and 5). The signal must be sampled at the measurement's rate.
Signal measure(const Signal& signal, const Measurement& measurement, const StreamKey& key);

/// x(t_i + delay), band-limited: whole periods by index, the rest by the phase of the spectrum of
/// the record continued by its mirror image (so that it has no jump; the error fades as 1/n² with
/// the distance n from the ends). Instants outside the record repeat its first or last sample.
/// Throws InvalidInput unless |delay| is shorter than the record.
std::vector<double> advanced(std::span<const double> samples, double delay, double sample_rate);

}  // namespace modcal
