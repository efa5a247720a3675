#include "libcalib/likelihood/unknown_bounds.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/libcalib/calibration_case.hpp"

namespace modcal::unknown_bounds_test {
namespace {

// A damping ratio of a share of 0.5 may be half of its initial value or twice of it; a gain of a
// share of 0.1 lies within 0.9 and 1.1, a delay within so many seconds.
TEST(UnknownBounds, OfADampingRatioAreAsManyTimesUpAsDown) {
  ModelPoint initial = paper_truth(8);
  UnknownsOptions options;
  options.damping = "each";
  options.sensor[Sensor::kGain].free = options.sensor[Sensor::kDelay].free = true;
  const StringUnknowns unknowns = StringUnknowns::frequencies(initial, options);
  ParameterRanges ranges;
  ranges.damping = 0.5;
  ranges.sensors[Sensor::kGain] = 0.1;
  ranges.sensors[Sensor::kDelay] = 2e-5;
  const UnknownBounds bounds = unknown_bounds(unknowns, initial, ranges);
  std::size_t ratios = 0, sensors = 0;
  for (Eigen::Index i = 0; i < unknowns.named(); ++i) {
    const ParameterName& name = unknowns.parameters()[static_cast<std::size_t>(i)];
    if (name.kind == ParameterKind::kDampingRatio) {
      EXPECT_NEAR(bounds.upper[i], std::log(2.0), 1e-15) << i;
      EXPECT_NEAR(bounds.lower[i], -std::log(2.0), 1e-15) << i;
      ++ratios;
    } else if (name.kind == ParameterKind::kSensor && name.index == Sensor::kGain) {
      EXPECT_NEAR(bounds.upper[i], std::log(1.1), 1e-15);
      EXPECT_NEAR(bounds.lower[i], std::log(0.9), 1e-15);
      ++sensors;
    } else if (name.kind == ParameterKind::kSensor && name.index == Sensor::kDelay) {
      EXPECT_NEAR(bounds.upper[i], 2e-5, 1e-20);
      EXPECT_NEAR(bounds.lower[i], -2e-5, 1e-20);
      ++sensors;
    }
  }
  EXPECT_EQ(ratios, 8u);
  EXPECT_EQ(sensors, 2u);
}

// Beyond half the gain, ten milliseconds or 50 Hz it is another defect than a sensor's.
TEST(StringUnknowns, AdmitNoSensorThatIsNone) {
  UnknownsOptions options;
  for (std::size_t i = 0; i < Sensor::kCount; ++i) options.sensor[i].free = true;
  const StringUnknowns unknowns = StringUnknowns::frequencies(paper_truth(8), options);
  const double farthest[] = {0.7, 1e-2, 2.0 * M_PI * 50.0};
  for (std::size_t i = 0; i < Sensor::kCount; ++i) {
    const auto at =
        static_cast<Eigen::Index>(*unknowns.parameters().find(ParameterKind::kSensor, i));
    for (const double share : {0.9, 1.1}) {
      Eigen::VectorXd theta = unknowns.start();
      theta[at] += share * farthest[i];
      EXPECT_EQ(unknowns.admits(theta), share < 1.0) << i;
    }
  }
}

}  // namespace
}  // namespace modcal::unknown_bounds_test
