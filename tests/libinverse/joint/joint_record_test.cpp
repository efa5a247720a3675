// The joint estimate of what was recorded: any beginning, modes above, noise that is not told.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/libinverse/joint/joint_case.hpp"

namespace modcal::joint_record_test {
namespace {

TEST(JointRecord, MayBeginInMidMotion) {
  // Four periods cut from a longer record; the sensors' levels are lost.
  const std::size_t samples = 1045, before = 3000;
  const ModalBasis basis = violin_g();
  DrivenString string = drive(basis, kPosition, jumping_force(before + samples, StreamKey(2)));
  for (auto& reaction : string.reaction) {
    reaction.erase(reaction.begin(), reaction.begin() + before);
    remove_mean(reaction);
  }
  std::vector<double> force(string.force.begin() + before, string.force.end());
  remove_mean(force);
  JointOptions transient;
  transient.truncation = "transient";
  transient.noise_rms[0] = transient.noise_rms[1] = 1e-8;
  JointOptions contour = transient;
  contour.truncation = "shifted_contour";
  const auto error_with = [&](const JointOptions& options) {
    auto identified = estimate_with(options, basis, string.pair()).result.force;
    remove_mean(identified);
    return middle_error(identified, force);
  };
  EXPECT_LT(error_with(transient), 0.15);
  EXPECT_GT(error_with(contour), 0.5);
}

// Two thirds of a second of a longer record: the string's own motion before it goes on in it.
TEST(JointRecord, TellsTheMotionFromMidMotionOn) {
  const std::size_t samples = 16384, before = 3000;
  const ModalBasis basis = violin_g();
  DrivenString string = drive(basis, kPosition, jumping_force(before + samples, StreamKey(3)));
  add_noise(string, 0.01, StreamKey(4));
  const auto cut = [](std::vector<double>& signal) {
    signal.erase(signal.begin(), signal.begin() + before);
    remove_mean(signal);
  };
  for (auto* signal : {&string.reaction[0], &string.reaction[1], &string.force,
                       &string.displacement, &string.velocity}) {
    cut(*signal);
  }
  const std::array<ReactionPair, 3> records = {
      string.pair(), {string.reaction[0], {}}, {std::span<const double>{}, string.reaction[1]}};
  for (const ReactionPair& record : records) {
    const Estimate estimate = estimate_with({}, basis, record);
    EXPECT_EQ(figure(estimate, "sigma"), 0.0);  // ends unknown, by itself
    EXPECT_THAT(estimate.notes, testing::Contains(testing::HasSubstr("starts at rest")));
    const auto judge = [&](std::vector<double> identified, const std::vector<double>& truth,
                           double deviation, double largest) {
      remove_mean(identified);
      EXPECT_LT(middle_error(identified, truth), largest);
      std::size_t inside = 0;
      for (std::size_t j = 0; j < samples; ++j) {
        inside += std::abs(identified[j] - truth[j]) < 1.96 * deviation ? 1 : 0;
      }
      // The band is the same all along the record, the error grows towards its beginning.
      EXPECT_GT(static_cast<double>(inside), 0.93 * static_cast<double>(samples));
    };
    judge(estimate.result.force, string.force, estimate.force_deviation, 0.6);
    judge(estimate.result.displacement, string.displacement, estimate.displacement_deviation, 0.02);
    judge(estimate.result.velocity, string.velocity, estimate.velocity_deviation, 0.2);
  }
}

// What lies above the modes of a real string the data do not tell: three modes below the highest
// one a record's estimate ends, and says so; a simulated string has no others.
TEST(JointRecord, EndsBelowTheHighestMode) {
  const std::size_t samples = 8192;
  const ModalBasis basis = violin_g();
  const DrivenString string =
      drive(basis, kPosition, jumping_force(samples, StreamKey(4)), {}, true);
  // Under a window: the growing weight makes the record's end and its beginning differ.
  const auto power_above = [](std::vector<double> force, double frequency) {
    for (std::size_t j = 0; j < force.size(); ++j) {
      const double turn = (static_cast<double>(j) + 0.5) / static_cast<double>(force.size());
      force[j] *= std::pow(std::sin(std::numbers::pi * turn), 2);
    }
    const std::vector<Complex> spectrum = RealFft(force.size()).forward(force);
    double power = 0.0, all = 0.0;
    for (std::size_t k = 1; k < spectrum.size(); ++k) {
      const double at = static_cast<double>(k) * kRate / static_cast<double>(force.size());
      all += std::norm(spectrum[k]);
      if (at > frequency) power += std::norm(spectrum[k]);
    }
    return power / all;
  };
  JointOptions options;
  options.noise_rms[0] = options.noise_rms[1] = 1e-4;
  const Estimate record = estimate_with(options, basis, string.pair(), true);
  EXPECT_EQ(record.band_limit, basis.frequency(46));
  // The contour's weight blurs the limit by σ/2π, less than 1 Hz.
  EXPECT_LT(power_above(record.result.force, 1.05 * basis.frequency(46)), 1e-5);
  ASSERT_EQ(record.notes.size(), 1u);
  EXPECT_THAT(record.notes[0], testing::HasSubstr("3 modes below the highest of 50"));
  const Estimate simulated = estimate_with(options, basis, string.pair(), false);
  EXPECT_TRUE(std::isnan(simulated.band_limit));
  EXPECT_GT(power_above(simulated.result.force, 1.05 * basis.frequency(46)), 1e-4);
  EXPECT_TRUE(simulated.notes.empty());
  options.band_limit = 5000.0;
  const Estimate stated = estimate_with(options, basis, string.pair(), true);
  EXPECT_EQ(stated.band_limit, 5000.0);
  EXPECT_TRUE(stated.notes.empty());
  options.band_limit = std::numeric_limits<double>::quiet_NaN();
  options.limit_to_top_mode = true;
  EXPECT_NEAR(estimate_with(options, basis, string.pair(), true).band_limit,
              1.01 * basis.frequency(49), 1e-6);
}

// Above its modes a real string is not silent: what is read there is five times the noise, what the
// cross relation leaves is the noise.
TEST(JointRecord, HasTheNoiseThatTheCrossRelationLeaves) {
  const std::size_t samples = 16384;
  const ModalBasis basis = violin_g();
  for (const double level : {0.002, 0.02}) {
    DrivenString string = drive(basis, kPosition, jumping_force(samples, StreamKey(4)), {}, true);
    SensorNoiseLevel truth;
    add_noise(string, level, StreamKey(5), &truth);
    const Estimate found = estimate_with({}, basis, string.pair(), true);
    // Weighted by exp(−8 t/T) a sixteenth of the bins is independent: 3 %, by their weights twice.
    EXPECT_NEAR(figure(found, "noise_rms_1"), truth.rms[0], 0.12 * truth.rms[0]) << level;
    EXPECT_NEAR(figure(found, "noise_rms_2"), truth.rms[1], 0.12 * truth.rms[1]) << level;
  }
}

// A contact 2 mm beside the true one moves every zero of the transfer functions. Its error along
// the force is as large as across it, which both reactions tell.
TEST(JointRecord, HasBandsThatHoldWhatTheModelLacks) {
  const std::size_t samples = 16384;
  const ModalBasis basis = violin_g();
  DrivenString string =
      drive(basis, kPosition + 2e-3, jumping_force(samples, StreamKey(5)), {}, true);
  add_noise(string, 0.01, StreamKey(6));
  JointOptions options;
  options.band_limit = kRate;  // none, so that the truth is that of the whole band
  const Estimate estimate = estimate_with(options, basis, string.pair(), true);
  EXPECT_THAT(estimate.warnings, testing::Contains(testing::HasSubstr("contradict")));
  std::vector<double> force = estimate.result.force, truth = string.force;
  remove_mean(force);
  remove_mean(truth);
  std::size_t inside = 0;
  for (std::size_t j = 0; j < samples; ++j) {
    inside += std::abs(force[j] - truth[j]) < 1.96 * estimate.force_deviation ? 1 : 0;
  }
  EXPECT_GT(static_cast<double>(inside), 0.8 * static_cast<double>(samples));
}

// Below f_1 R_2 tells little of the force and R_1 nearly all: what R_1 errs by is the force's error
// and moves the cross relation by a tenth of that.
TEST(JointRecord, HasBandsThatHoldWhatEitherSensorErrsBy) {
  const std::size_t samples = 16384;
  const ModalBasis basis = violin_g();
  const DrivenString good = drive(basis, kPosition, jumping_force(samples, StreamKey(7)), {}, true);
  const double limit = basis.frequency(30);
  const RealFft fft(samples);
  JointOptions options;
  options.band_limit = limit;
  struct Band {
    double held;   // share of the force's error in it
    double width;  // its deviation over that of the error
    std::vector<std::string> warnings;
  };
  const auto band_with = [&](double ramp_1, double ramp_2) {
    DrivenString string = good;
    add_noise(string, 0.01, StreamKey(8));
    const double ramps[] = {ramp_1, ramp_2};
    for (std::size_t r = 0; r < 2; ++r) {
      const double size = ramps[r] * standard_deviation(good.reaction[r]);
      for (std::size_t j = 0; j < samples; ++j) {
        string.reaction[r][j] += size * static_cast<double>(j) / static_cast<double>(samples);
      }
    }
    const Estimate estimate = estimate_with(options, basis, string.pair(), true);
    std::vector<double> off = estimate.result.force;
    for (std::size_t j = 0; j < samples; ++j) off[j] -= string.force[j];
    std::vector<Complex> spectrum = fft.forward(off);
    std::fill(spectrum.begin() + static_cast<std::ptrdiff_t>(limit * samples / kRate) + 1,
              spectrum.end(), Complex{});
    spectrum[0] = 0.0;
    off = fft.inverse(std::move(spectrum));
    const auto inside = std::ranges::count_if(
        off, [&](double x) { return std::abs(x) < 1.96 * estimate.force_deviation; });
    return Band{static_cast<double>(inside) / static_cast<double>(samples),
                estimate.force_deviation / standard_deviation(off), estimate.warnings};
  };
  const Band clean = band_with(0.0, 0.0);
  EXPECT_GT(clean.held, 0.93);
  EXPECT_THAT(clean.warnings, testing::IsEmpty());
  for (const double ramp : {0.1, 1.0}) {
    const Band band = band_with(ramp, 0.0);
    EXPECT_GT(band.held, 0.95) << ramp;
    EXPECT_NEAR(band.width, 1.0, 0.4) << ramp;
    EXPECT_THAT(band.warnings, testing::Contains(testing::HasSubstr("contradict each other")));
  }
  // Which of both errs is not told where the force itself may be as slow.
  EXPECT_GT(band_with(0.0, 1.0).held, 0.95);
  EXPECT_GT(band_with(1.0, 1.0).held, 0.95);
  EXPECT_GT(band_with(-0.3, 0.3).held, 0.95);
}

}  // namespace
}  // namespace modcal::joint_record_test
