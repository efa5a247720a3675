#include "libinverse/observer/observed_record.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "libinverse/observer/tuning.hpp"
#include "libsim/base/error.hpp"
#include "libsim/signal/statistics.hpp"
#include "tests/libinverse/observer/bowed_record.hpp"

namespace modcal::observer::observed_record_test {
namespace {

using testing::HasSubstr;

ObservedRecord observed(const BowedRecord& r) {
  return observe_record(r.basis, r.scene.bow.position, kRecordRate, r.left.samples,
                        r.right.samples);
}

// 0.2 s hold 10 240 samples, 2 600 bins of the band: the Hann window leaves 2 600/1.94 independent
// ones (its equivalent width), sd of the rms 1/√(4·1 340)·√2 = 1.9 %; the signal's leakage and the
// static remainder of the highest modes stay below that at 5 %.
TEST(ObservedRecord, ReadsNoiseAndOffsets) {
  const BowedRecord r = bowed_record(0.2, 0.05);
  const ObservedRecord record = observed(r);
  const Signal* clean[2] = {&r.truth.left_reaction, &r.truth.right_reaction};
  for (int end = 0; end < 2; ++end) {
    const double noise = 0.05 * standard_deviation(clean[end]->samples);
    EXPECT_NEAR(record.raw_noise[end] / noise, 1.0, 0.08);
    // The mean was taken off: before the first wave the record stands at minus the mean.
    const double deviation = noise / std::sqrt(static_cast<double>(record.silent[end]));
    EXPECT_NEAR(record.offset[end], -mean(clean[end]->samples), 5.0 * deviation);
  }
  EXPECT_EQ(record.silent[0], 11u);   // 0.03 m at 129.36 m/s
  EXPECT_EQ(record.silent[1], 118u);  // 0.30 m
}

// The offset that the silent samples of a clean record miss, against the ripple of the 2 Z₀ v_bow =
// 0.080 N that the bow draws before a wave is back. Its first 0.3 ms are no step: the string must
// catch the bow first, and the adherence rings; a factor of two either way.
TEST(ObservedRecord, KnowsTheRippleBeforeTheFirstWave) {
  for (const bool light : {false, true}) {
    const BowedRecord r = light ? light_record(0.05, 0.0) : bowed_record(0.05, 0.0);
    const ObservedRecord record =
        observe_record(r.basis, r.scene.bow.position, r.rate, r.left.samples, r.right.samples);
    const double missed = std::abs(record.offset[0] + mean(r.truth.left_reaction.samples));
    const double force = 2.0 * 3.1e-3 * (2.0 * 0.33 * 196.0) * 0.1;
    const double ripple = force * silent_ripple(r.basis, r.scene.bow.position, End::kLeft, r.rate);
    EXPECT_GT(missed, 0.5 * ripple) << light;
    EXPECT_LT(missed, 2.0 * ripple) << light;
  }
}

// A sensor whose noise is known to be large has no part in the estimate, whatever it reads.
TEST(LinearEstimate, TrustsASensorByItsNoise) {
  const BowedRecord r = bowed_record(0.1, 0.01);
  ObservedRecord record = observed(r);
  record.noise[1] = 1e6 * record.noise[0];
  const std::vector<double> force = linear_estimate(record).force;
  for (double& sample : record.reaction[1]) sample *= -3.0;
  EXPECT_LT(relative_rms_error(linear_estimate(record).force, force), 1e-6);
}

TEST(ObservedRecord, KeepsAFloorUnderTheNoise) {
  const BowedRecord r = bowed_record(0.1, 0.0);
  const ObservedRecord record = observed(r);
  EXPECT_DOUBLE_EQ(record.noise[0], kNoiseFloor * standard_deviation(r.left.samples));
  EXPECT_LT(record.raw_noise[0], record.noise[0]);
}

TEST(ObservedRecord, RefusesWhatItCannotUse) {
  BowedRecord r = bowed_record(0.05, 0.01);
  r.left.samples[17] = std::numeric_limits<double>::quiet_NaN();
  try {
    observed(r);
    FAIL() << "NaN accepted";
  } catch (const InvalidInput& error) {
    EXPECT_THAT(error.what(), HasSubstr("sample 17 of the reaction at x = 0"));
  }
  r = bowed_record(0.05, 0.01);
  r.right.samples.pop_back();
  EXPECT_THROW(observed(r), InvalidInput);
  r = bowed_record(0.05, 0.01);
  r.right.samples.assign(r.right.samples.size(), 1.0);
  EXPECT_THROW(observed(r), InvalidInput);
  r = bowed_record(0.015, 0.01);  // 2.9 periods
  EXPECT_THROW(observed(r), InvalidInput);
}

TEST(ObservedRecord, NeedsABandAboveTheModes) {
  const BowedRecord r = bowed_record(0.05, 0.01);
  EXPECT_THROW(noise_above(r.left.samples, kRecordRate, 25000.0), InvalidInput);
}

}  // namespace
}  // namespace modcal::observer::observed_record_test
