// What a calibrated model tells of the force: its band holds what the string may be, and the
// sensors are made alike.
#include "experiments/kinds/calibrate/calibrate_force.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "libcalib/identifiability/tuning.hpp"
#include "libsim/signal/statistics.hpp"
#include "tests/folder_test.hpp"
#include "tests/libsim/dynamics/paper_case.hpp"

namespace modcal::calibrate_force_test {
namespace {

class CalibrateForce : public FolderTest {
 protected:
  CalibrateForce() {
    ObservationOptions& observation = options_.inversion.observation;
    observation.has_scene = true;
    observation.truth.scene = paper_scene();
    observation.truth.scene.duration = 0.2;
    observation.truth.simulator.select("modal_event");
    observation.measurement.noise_level = 0.01;
    observed_ =
        observe(observation, {.force = true}, work_.truths, options_.inversion.key(), folder());
  }

  // The true string, the factor of whose damping has so much deviation.
  CalibrationOutcome with_damping(double deviation) const {
    CalibrationOutcome outcome;
    const ModelPoint model{.basis = observed_.basis, .contact = observed_.contact};
    auto fit = std::make_shared<ContinuationResult>();
    const StringUnknowns unknowns = StringUnknowns::law(model, observed_.fundamental, 0.0);
    fit->posterior = {unknowns, unknowns.start(),
                      Eigen::MatrixXd::Zero(unknowns.size(), unknowns.size())};
    const Eigen::Index damping = unknowns.damping();
    fit->posterior.covariance(damping, damping) = deviation * deviation;
    outcome.result.continuation = fit;
    outcome.refined = {model.basis, model.contact};
    return outcome;
  }

  CalibratedForce force_with(const CalibrationOutcome& outcome) const {
    return identify_calibrated(options_, observed_, outcome, {.force = true, .velocity = true});
  }

  std::vector<double> force_of(double factor) const {
    AssumedModel model{observed_.basis, observed_.contact};
    for (double& zeta : model.basis.zeta) zeta *= factor;
    return identify(observed_, model, options_.inversion.inversion, {.force = true}, nullptr)
        .front()
        .estimate.result.force;
  }

  SharedWork work_;
  CalibrateOptions options_;
  Observation observed_;
};

TEST_F(CalibrateForce, HasTheBandOfTheInversionWhereTheStringIsKnown) {
  const AssumedModel model{observed_.basis, observed_.contact};
  const Estimate plain = identify(observed_, model, options_.inversion.inversion,
                                  {.force = true, .velocity = true}, nullptr)
                             .front()
                             .estimate;
  const CalibratedForce force = force_with(with_damping(0.0));
  ASSERT_EQ(force.sides.size(), 1u);
  const Estimate& found = force.sides[0].estimate;
  EXPECT_EQ(found.result.force, plain.result.force);
  EXPECT_NEAR(found.force_deviation / plain.force_deviation, 1.0, 1e-12);
  EXPECT_NEAR(found.velocity_deviation / plain.velocity_deviation, 1.0, 1e-12);
  // No fit, no models.
  CalibrationOutcome without = with_damping(0.0);
  without.result.continuation.reset();
  EXPECT_TRUE(force_with(without).sides[0].estimate.force_deviations.empty());
}

TEST_F(CalibrateForce, HasAWiderBandByWhatTheStringMayBe) {
  // So small that the force answers in proportion: what is left is the change's own, 1e-3 of it.
  constexpr double kDeviation = 1e-3;
  const double known = force_with(with_damping(0.0)).sides[0].estimate.force_deviation;
  const CalibratedForce force = force_with(with_damping(kDeviation));
  const std::vector<double> up = force_of(std::exp(kDeviation)),
                            down = force_of(std::exp(-kDeviation));
  std::vector<double> change(up.size()), added(up.size());
  for (std::size_t j = 0; j < up.size(); ++j) {
    change[j] = 0.5 * std::abs(up[j] - down[j]);
    added[j] = std::sqrt(
        std::max(0.0, std::pow(force.sides[0].estimate.force_deviations[j], 2) - known * known));
  }
  const double ratio = added[1000] / change[1000];
  // The root of a mean square of kModelsDrawn normal numbers, times Student's quantile.
  const double expected = student_quantile(kModelsDrawn) / student_quantile(0);
  EXPECT_GT(ratio, 0.5 * expected);
  EXPECT_LT(ratio, 1.7 * expected);
  EXPECT_GT(correlation(added, change), 0.999);
}

TEST(SensorCorrection, TakesOutGainDelayAndHighPass) {
  // A swing that dies out, read through 1.05 exp(-s 20 us) s/(s + 2 pi 4 Hz).
  constexpr double kRate = 50000.0, kCorner = 8.0 * M_PI;
  Observation observation{.sample_rate = kRate};
  Signal truth{.quantity = "R2", .unit = "N", .sample_rate = kRate, .samples = {}};
  for (std::size_t j = 0; j < 25000; ++j) {
    const double t = static_cast<double>(j) / kRate;
    truth.samples.push_back(t * std::exp(-20.0 * t) * std::sin(2.0 * M_PI * 150.0 * t));
  }
  Signal sensed = truth;
  double held = 0.0;  // of the corner's low-pass, which the high-pass takes away
  for (std::size_t j = 0; j < truth.size(); ++j) {
    const double now = j > 0 ? truth.samples[j - 1] : 0.0;
    const double before = j > 1 ? truth.samples[j - 2] : 0.0;
    const double c = 0.5 * kCorner / kRate;
    held = ((1.0 - c) * held + c * (now + before)) / (1.0 + c);
    sensed.samples[j] = 1.05 * (now - held);
  }
  remove_mean(sensed.samples);
  remove_mean(truth.samples);
  observation.reactions[1] = sensed;
  const Sensor sensors{.gain = 1.05, .delay = 1.0 / kRate, .corner = kCorner};
  const Observation corrected = with_sensors_alike(observation, sensors);
  double largest = 0.0, difference = 0.0, uncorrected = 0.0;
  for (std::size_t j = 0; j + 1 < truth.size(); ++j) {
    largest = std::max(largest, std::abs(truth.samples[j]));
    difference =
        std::max(difference, std::abs(corrected.reactions[1]->samples[j] - truth.samples[j]));
    uncorrected = std::max(uncorrected, std::abs(sensed.samples[j] - truth.samples[j]));
  }
  // The line that is taken out also takes the signal's own, which is 1e-3 of it.
  EXPECT_LT(difference, 5e-3 * largest);
  EXPECT_GT(uncorrected, 5e-2 * largest);
  EXPECT_EQ(with_sensors_alike(observation, {}).reactions[1]->samples, sensed.samples);
  EXPECT_EQ(correction_text(observation, {}), "");
}

}  // namespace
}  // namespace modcal::calibrate_force_test
