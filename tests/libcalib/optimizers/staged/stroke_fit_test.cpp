#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "libcalib/optimizers/staged/continuation.hpp"
#include "tests/libcalib/likelihood/bowed_case.hpp"

namespace modcal::stroke_fit_test {
namespace {

// 46 of 50 frequencies are fixed: they take nothing of what 1027 bins tell, 2 % of it if they did.
// The verdict's own measure, by what the fit takes, agrees to a part of what the four others do.
TEST(StrokeFit, AStagesChiSquareCountsNoUnknownThatIsHeld) {
  const BowedCase bowed = bowed_case(0.0285, 1.39e-4, 0.1);
  const NoisyRecords records = noisy(bowed, 0.02, 3);
  const CalibrationData data =
      CalibrationData::of_records(records.reactions[0], records.reactions[1], records.sample_rate);
  ContinuationOptions options{.law_width = 2e-3,
                              .left_noise = records.deviation[0],
                              .right_noise = records.deviation[1],
                              .restarts = 0};
  for (std::size_t n = 1; n <= 46; ++n) {
    options.unknowns.fixed.push_back({fmt::format("f_{}", n), bowed.truth.basis.frequency(n - 1)});
  }
  const ContinuationResult fit = calibrate_by_continuation(bowed.truth, data, options);
  EXPECT_TRUE(fit.right) << fit.chi2;
  const auto stage = std::ranges::find(fit.stages, "free, whole record", &FitStage::name);
  ASSERT_NE(stage, fit.stages.end());
  EXPECT_NEAR(stage->chi2 / fit.chi2, 1.0, 3e-3);
}

}  // namespace
}  // namespace modcal::stroke_fit_test
