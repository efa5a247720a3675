#include <fmt/ranges.h>

#include "experiments/kinds/calibrate/calibrate_force.hpp"
#include "libcalib/identifiability/tuning.hpp"
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

void require_agreement(const CalibrationOptions& calibration, const Estimator& estimator,
                       bool recorded) {
  const std::string_view words[] = {"tension", "support"};
  const bool bending = calibration.support.support(recorded).bending;
  MODCAL_REQUIRE(estimator.feels_bending().value_or(bending) == bending,
                 "the calibration takes the ends to feel the {}, the estimator the {}: state "
                 "calibration.reaction: {}, and for the estimator the same or nothing; estimators "
                 "joint, auto and linear_limit follow either, the others the tension alone",
                 words[bending ? 1 : 0], words[bending ? 0 : 1], words[bending ? 0 : 1]);
  const UnknownsOptions& unknowns = calibration.parameters.unknowns;
  const bool found = recorded && calibration.by_schedule() && !unknowns.exact_sensors;
  const bool corrected = found || unknowns.sensors().may_differ();
  const auto [left, right] = estimator.sensors();
  MODCAL_REQUIRE(
      !corrected || (left.gain == right.gain && left.delay == right.delay),
      "the reaction at x = L is corrected for its sensor as the calibration has it before "
      "the estimator sees it: gain2 {:g} and delay2 {:g} s would take it out once more; "
      "leave them out, or state those of x = 0 (gain1 {:g}, delay1 {:g} s)",
      right.gain, right.delay, left.gain, left.delay);
}

std::string default_text(const CalibrationOptions& calibration, const Observation& observation) {
  if (observation.truth || !calibration.by_schedule()) return "";
  const UnknownsOptions& stated = calibration.parameters.unknowns;
  const UnknownsOptions known = stated.of_records(observation.sample_rate, observation.basis);
  std::vector<std::string> texts;
  for (std::size_t i = stated.priors.size(); i < known.priors.size(); ++i) {
    const ParameterPrior& prior = known.priors[i];
    const std::string_view unit = unit_of_parameter(prior.parameter);
    texts.push_back(fmt::format("{} {:g} +- {:.3g}{}{}", prior.parameter, prior.mean,
                                prior.deviation, unit == "1" ? "" : " ", unit == "1" ? "" : unit));
  }
  if (known.response.free && !stated.response.free) {
    texts.push_back(fmt::format("the smooth response of the sensors +- {:g} every {:.4g} Hz",
                                known.response.width, known.response.spacing));
  }
  if (known.damping != stated.damping) {
    texts.push_back(fmt::format("every ln zeta_n +- {:g}, {:g} of it each by itself",
                                known.damping_width, known.damping_scatter));
  }
  if (texts.empty()) return "";
  return fmt::format(
      "Free unasked in a record, with standard deviations of the priors: {}. sensors: [exact] and "
      "damping: fixed hold them. In the deviations besides: a second polarization +- {:g}, and a "
      "bridge that moves as far as the record does not tell it.",
      fmt::join(texts, ", "), kPolarizationWidth);
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
  if (!sensors.smooth.zero()) numbers.emplace_back("smooth response");
  return fmt::format(
      "The reaction at x = L was corrected for its sensor before the identification: {}.",
      fmt::join(numbers, ", "));
}

}  // namespace modcal
