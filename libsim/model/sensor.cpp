#include "libsim/model/sensor.hpp"

#include "libsim/signal/measurement.hpp"

namespace modcal {

std::vector<double> Sensor::undone(std::span<const double> samples, double sample_rate) const {
  std::vector<double> result = delay == 0.0
                                   ? std::vector<double>(samples.begin(), samples.end())
                                   : advanced(samples, delay, sample_rate);
  const double half = 0.5 * corner / sample_rate;
  double integral = 0.0, last = 0.0;
  for (double& sample : result) {
    integral += half * (sample + last);
    last = sample;
    sample = (sample + integral) / gain;
  }
  return result;
}

}  // namespace modcal
