#include "libinverse/modes/stabilization.hpp"

#include <gtest/gtest.h>

namespace modcal::stabilization_test {
namespace {

TEST(StablePoles, SpreadIsTheStandardDeviationOverTheOrders) {
  const StabilizationOptions options{.required = 3};
  std::vector<StabilizationPoint> diagram;
  for (std::size_t i = 0; i < 3; ++i) {
    DecayPole pole;
    pole.frequency = 100.0 + 0.1 * static_cast<double>(i);
    pole.damping_ratio = 0.01 + 2e-4 * static_cast<double>(i);
    diagram.push_back({2 + 2 * i, pole, static_cast<std::int64_t>(i + 1)});
  }
  const std::vector<StablePole> stable = stable_poles(diagram, options);
  ASSERT_EQ(stable.size(), 1u);
  EXPECT_EQ(stable[0].pole.frequency, 100.2);
  // Of three values a step apart: sqrt(2 step^2 / 2); differences of 100 are rounded to 1e-14.
  EXPECT_NEAR(stable[0].spread.frequency, 0.1, 1e-12);
  EXPECT_NEAR(stable[0].spread.damping_ratio, 2e-4, 1e-15);
  EXPECT_TRUE(stable_poles(diagram, {.required = 4}).empty());
}

}  // namespace
}  // namespace modcal::stabilization_test
