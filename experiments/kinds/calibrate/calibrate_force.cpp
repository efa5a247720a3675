#include "experiments/kinds/calibrate/calibrate_force.hpp"

#include "libcalib/identifiability/tuning.hpp"
#include "libinverse/joint/joint_inversion.hpp"
#include "libsim/base/task_loop.hpp"
#include "libsim/signal/statistics.hpp"

namespace modcal {
namespace {

// A corner that the data do not tell from none (3 sd) is none: to undo it would cost the level of
// the reaction.
Sensor told_sensors(const CalibrationResult& result) {
  Sensor sensors = result.model.sensors;
  if (!result.continuation) return sensors;
  const double deviation = result.continuation->sensor_deviation[Sensor::kCorner];
  const double corner = sensor_value(Sensor::kCorner, sensors);
  if (deviation > 0.0 && corner < 3.0 * deviation) sensors.corner = 0.0;
  return sensors;
}

// Of the signals of the refined model and of drawn ones: adds the mean square of what they differ
// by to the variances.
void widen(const std::vector<InversionResult>& signals, Estimate& estimate) {
  if (signals.size() < 2) {
    estimate.warnings.emplace_back(
        "no model that was drawn about the calibrated one can be a string's: the force's band is "
        "that of the string found alone, which is too narrow; state priors that hold it to what is "
        "known");
    return;
  }
  const std::size_t drawn = signals.size() - 1;
  // As many degrees of freedom as models: a band of so many deviations holds as much as that of a
  // normal distribution.
  const double wide = student_quantile(drawn) / student_quantile(0);
  for (const Quantity& quantity : kQuantities) {
    if (quantity.identified == nullptr || std::isnan(quantity.deviation_at(estimate, 0))) continue;
    const std::vector<double>& at = signals.front().*quantity.identified;
    if (at.empty()) continue;
    std::vector<double> deviations(at.size());
    for (std::size_t j = 0; j < at.size(); ++j) {
      double sum = 0.0;
      for (std::size_t i = 1; i <= drawn; ++i) {
        sum += std::pow((signals[i].*quantity.identified)[j] - at[j], 2);
      }
      deviations[j] = std::hypot(quantity.deviation_at(estimate, j),
                                 wide * std::sqrt(sum / static_cast<double>(drawn)));
    }
    estimate.*quantity.deviation = std::hypot(mean(deviations), standard_deviation(deviations));
    if (quantity.deviations) estimate.*quantity.deviations = std::move(deviations);
  }
  estimate.notes.push_back(fmt::format(
      "its deviation holds what the calibrated string may be, by {} models of the fit's posterior",
      drawn));
}

bool has_band(const SideIdentification& side) {
  return std::ranges::any_of(kQuantities, [&](const Quantity& quantity) {
    return quantity.deviation != nullptr && !std::isnan(quantity.deviation_at(side.estimate, 0));
  });
}

// By the refined model, then by those drawn. The joint inversion without deviations is the
// cheapest, and estimators that follow a friction law begin with it.
std::vector<InversionResult> signals_of_models(
    const CalibrateOptions& options, const Observation& measured, const CalibrationOutcome& outcome,
    const CalibratedForce& found, const InversionOutputs& outputs, const StopToken& stop) {
  const InversionOptions inversion = with_estimator("joint", options.inversion.inversion);
  const InversionOutputs signals{.force = outputs.force,
                                 .displacement = outputs.displacement,
                                 .velocity = outputs.velocity,
                                 .deviations = false};
  std::vector<ModelPoint> models = outcome.result.continuation->posterior.draw(
      kModelsDrawn, options.inversion.key().with("models of the band"));
  std::vector<InversionResult> results(models.size() + 1);
  const auto invert_with = [&](std::size_t i) {
    const auto invert = [&](const Observation& observation, const AssumedModel& model) {
      results[i] = std::move(
          identify(observation, model, inversion, signals, nullptr).front().estimate.result);
    };
    if (i == 0) return invert(found.observation, outcome.refined);
    ModelPoint& drawn = models[i - 1];
    drawn.basis.tension = outcome.refined.basis.tension;
    if (found.sensors.corner == 0.0) drawn.sensors.corner = 0.0;
    invert(with_sensors_alike(measured, drawn.sensors),
           {std::move(drawn.basis), drawn.contact, outcome.refined.bending});
  };
  for_each_task(results.size(), invert_with, stop);
  return results;
}

// Of a record that the model explains, and that alone holds the string.
double ringing_misfit(const CalibrateOptions& options, const Observation& observation,
                      const CalibrationOutcome& outcome) {
  const auto& found = outcome.result.continuation;
  const bool is_asked = found && found->right && !observation.truth;
  if (!is_asked || !starts_from_record(options.calibration)) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  StringSupport support = options.calibration.support.support(true);
  support.bending_open = false;  // a decay is one either way
  const JointInversion inversion(outcome.refined.basis, outcome.refined.contact,
                                 observation.samples(), observation.sample_rate,
                                 {.truncation = Truncation::kTransient, .support = support});
  JointWorkspace workspace;
  return inversion.ringing_misfit(
      {observation.reactions[0]->samples, observation.reactions[1]->samples}, {.rms = found->noise},
      found->lines, workspace);
}

}  // namespace

InversionOptions with_estimator(const char* name, InversionOptions options) {
  if (options.estimator.selected() != name) options.estimator = Choice<Estimator>(name);
  return options;
}

CalibratedForce identify_calibrated(const CalibrateOptions& options, const Observation& measured,
                                    const CalibrationOutcome& outcome,
                                    const InversionOutputs& outputs, const StopToken& stop) {
  const InvertOptions& inversion = options.inversion;
  CalibratedForce found{.sensors = told_sensors(outcome.result)};
  found.observation = with_sensors_alike(measured, found.sensors);
  found.sides = identify(found.observation, outcome.refined, inversion.inversion, outputs, nullptr);
  if (outcome.result.continuation && std::ranges::any_of(found.sides, has_band)) {
    const auto signals = signals_of_models(options, measured, outcome, found, outputs, stop);
    for (SideIdentification& side : found.sides) widen(signals, side.estimate);
  }
  found.ringing_misfit = ringing_misfit(options, found.observation, outcome);
  for (SideIdentification& side : found.sides) {
    score_side(found.observation, inversion.score, side);
  }
  return found;
}

}  // namespace modcal
