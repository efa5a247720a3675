#include "libsim/signal/measurement.hpp"

#include <vector>

#include "libsim/base/error.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {

void Measurement::visit(OptionVisitor& visitor) {
  visitor.number({.key = "sample_rate",
                  .meaning = "sampling rate of the recorder",
                  .unit = "Hz",
                  .range = Range::positive()},
                 sample_rate);
  visitor.number({.key = "noise_level",
                  .meaning = "noise standard deviation over that of each signal",
                  .unit = "1",
                  .range = Range::non_negative()},
                 noise_level);
  visitor.flag({.key = "remove_mean", .meaning = "remove the mean, as piezoelectric sensors do"},
               remove_mean);
}

Signal measure(const Signal& signal, const Measurement& measurement, const StreamKey& key) {
  MODCAL_REQUIRE(measurement.noise_level >= 0.0, "noise level {:g} must be >= 0",
                 measurement.noise_level);
  MODCAL_REQUIRE(signal.sample_rate == measurement.sample_rate,
                 "the signal is sampled at {:g} Hz, the measurement at {:g} Hz", signal.sample_rate,
                 measurement.sample_rate);
  Signal measured = signal;
  if (measurement.noise_level > 0.0) {
    const double deviation = measurement.noise_level * standard_deviation(signal.samples);
    std::vector<double> noise(signal.size());
    fill_standard_normal(key, noise);
    for (std::size_t i = 0; i < noise.size(); ++i) measured.samples[i] += deviation * noise[i];
  }
  if (measurement.remove_mean) remove_mean(measured.samples);
  return measured;
}

}  // namespace modcal
