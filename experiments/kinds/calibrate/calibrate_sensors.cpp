#include <fmt/ranges.h>

#include <span>
#include <vector>

#include "experiments/kinds/calibrate/calibrate_study.hpp"
#include "libsim/base/error.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

// Least squares, mean included.
void remove_line(std::span<double> samples) {
  remove_mean(samples);
  const double middle = 0.5 * static_cast<double>(samples.size() - 1);
  double product = 0.0, square = 0.0;
  for (std::size_t j = 0; j < samples.size(); ++j) {
    const double place = static_cast<double>(j) - middle;
    product += place * samples[j];
    square += place * place;
  }
  const double slope = square > 0.0 ? product / square : 0.0;
  for (std::size_t j = 0; j < samples.size(); ++j) {
    samples[j] -= slope * (static_cast<double>(j) - middle);
  }
}

}  // namespace

Observation with_sensors_alike(Observation observation, const Sensor& sensors) {
  std::optional<Signal>& reaction = observation.reactions[static_cast<int>(End::kRight)];
  if (sensors.alike() || !reaction) return observation;
  std::vector<double>& samples = reaction->samples;
  samples = sensors.undone(samples, observation.sample_rate);
  if (sensors.corner != 0.0) remove_line(samples);
  return observation;
}

void require_sensors_once(const CalibrationOptions& calibration, const Estimator& estimator) {
  const bool corrected = calibration.parameters.unknowns.sensors().may_differ();
  const SensorOptions stated = estimator.sensors();
  MODCAL_REQUIRE(
      !corrected || stated.alike(),
      "the reaction at x = L is corrected for its sensor as the calibration has it before "
      "the estimator sees it: gain2 {:g} and delay2 {:g} s would take it out once more; "
      "leave them out, or state those of x = 0 (gain1 {:g}, delay1 {:g} s)",
      stated.gain[1], stated.delay[1], stated.gain[0], stated.delay[0]);
}

std::string correction_text(const Observation& observation, const Sensor& sensors) {
  if (sensors.alike() || !observation.reaction(End::kRight)) return "";
  std::vector<std::string> numbers;
  for (std::size_t i = 0; i < Sensor::kCount; ++i) {
    const ParameterType& type = sensor_type(i);
    const std::string number = fmt::format("{:.{}g}", sensor_value(i, sensors), type.digits);
    numbers.push_back(fmt::format("{} {}{}{}", type.name, number, type.unit == "1" ? "" : " ",
                                  type.unit == "1" ? "" : type.unit));
  }
  return fmt::format(
      "The reaction at x = L was corrected for its sensor before the identification: {}.",
      fmt::join(numbers, ", "));
}

}  // namespace modcal
