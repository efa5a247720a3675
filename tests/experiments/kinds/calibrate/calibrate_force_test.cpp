// The band of a force that a calibrated model tells holds what the string may be.
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

}  // namespace
}  // namespace modcal::calibrate_force_test
