// Kind "identify" on recorded plucks: sums of damped sinusoids that no string model of modcal made.
#include "experiments/kinds/identify/identify_record.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "experiments/loader.hpp"
#include "experiments/study/study.hpp"
#include "libsim/base/random.hpp"
#include "tests/experiments/kinds/run_document.hpp"
#include "tests/folder_test.hpp"

namespace modcal::identify_record_test {
namespace {

using testing::HasSubstr;

class RecordedPluck : public FolderTest {
 protected:
  static constexpr const char* kLowModes =
      "fundamental: 197 Hz\nidentification: {highest_frequency: 900 Hz}\n";
  static constexpr double kRate = 20e3, kHeld = 0.3, kNoise = 0.01, kMains = 50.04;

  static double frequency(int n) { return 196.0 * n * std::sqrt(1.0 + 1.5e-4 * n * n); }
  static double ratio(int n) { return 1e-3 + 1e-4 * n; }

  struct Spoiled {
    double split = 0.0;   // in a second plane each mode is so much higher, a tenth as large
    double hum = 0.0;     // amplitude of the first of eight lines of the mains, 1/h of the others
    double step = 0.0;    // of the values
    double faster = 1.0;  // of the damping ratios
    double glide = 0.0;   // frequencies are so much higher at first
  };
  // The string is held for a while, bent to one side, and let go. Every mode is driven.
  void write_pluck(const Spoiled& spoiled) const {
    const double split = spoiled.split;
    const auto ratio = [&](int n) { return spoiled.faster * RecordedPluck::ratio(n); };
    const auto count = static_cast<std::size_t>(1.5 * kRate);
    std::vector<double> left(count), right(count);
    fill_standard_normal(StreamKey(1).with("left"), left);
    fill_standard_normal(StreamKey(1).with("right"), right);
    std::string text = fmt::format("# sample_rate: {} Hz\nR1 [N],R2 [N]\n", kRate);
    for (std::size_t j = 0; j < count; ++j) {
      const double t = std::max(0.0, static_cast<double>(j) / kRate - kHeld);
      double sums[2] = {kNoise * left[j], kNoise * right[j]};
      for (int n = 1; n <= 11; ++n) {
        const double omega = 2.0 * std::numbers::pi * frequency(n);
        const double rate = 2.0 * 2.0 * std::numbers::pi * frequency(1) * ratio(1);
        const double gone = t - spoiled.glide * std::expm1(-rate * t) / rate;
        const double moved = std::exp(-ratio(n) * omega * t) * std::cos(omega * gone) / n;
        sums[0] += moved;
        if (split > 0.0) {
          const double other = (1.0 + split) * omega;
          sums[0] += 0.1 * std::exp(-ratio(n) * other * t) * std::cos(other * t) / n;
        }
        sums[1] -= (n % 2 == 0 ? -1.0 : 1.0) * moved;
      }
      const double turn = 2.0 * std::numbers::pi * kMains * static_cast<double>(j) / kRate;
      for (int h = 1; h <= 8 && spoiled.hum > 0.0; ++h) {
        sums[0] += spoiled.hum / h * std::cos(h * (turn + 1.0));
        sums[1] += spoiled.hum / h * std::cos(h * (turn + 2.0));
      }
      for (double& sum : sums) {
        if (spoiled.step > 0.0) sum = spoiled.step * std::round(sum / spoiled.step);
      }
      text += fmt::format("{:.12g},{:.12g}\n", sums[0], sums[1]);
    }
    write("pluck.csv", text);
  }
  // Of frequencies and damping ratios off the truth, in their deviations.
  static double mean_square(const nlohmann::json& document, double faster) {
    double squares = 0.0;
    for (const auto& mode : document["modes"]) {
      const int n = mode["n"].get<int>();
      const auto off = [&](const std::string& key, double truth) {
        return (mode[key].get<double>() - truth) /
               mode[key == "zeta" ? "zeta_sd" : "f_sd_hz"].get<double>();
      };
      squares +=
          std::pow(off("f_hz", frequency(n)), 2) + std::pow(off("zeta", faster * ratio(n)), 2);
    }
    return squares / (2.0 * static_cast<double>(document["modes"].size()));
  }
  StudyResult run(const std::string& record, const std::string& keys) const {
    write("identify.yaml", "kind: identify\nrecord: {file: " + record +
                               ", left: {channel: R1}, right: {channel: R2}}\n" + keys);
    return run_document(read_yaml_file(path("identify.yaml")));
  }
};

TEST_F(RecordedPluck, HasItsModesWithinTheirErrorBars) {
  write_pluck({});
  const StudyResult result = run("pluck.csv", "fundamental: 197 Hz\n");
  ASSERT_EQ(result.status, report::Status::kOk) << result.answer;
  const auto document = nlohmann::json::parse(result.files.at(0).second);
  ASSERT_EQ(document["modes"].size(), 11u);
  // The period of 5.1 ms in which the string is let go lies around .3 s; the next begins the decay.
  EXPECT_NEAR(document["begin_s"].get<double>(), kHeld + 0.0052, 0.0052);
  for (const auto& mode : document["modes"]) EXPECT_TRUE(mode["f_true_hz"].is_null());
  const double squares = mean_square(document, 1.0);
  // The mean of 22 squared standard normal numbers is 1 ± .3.
  EXPECT_LT(squares, 2.2);
  EXPECT_GT(squares, 0.3);
  EXPECT_NEAR(document["stiff_string_law"]["B"].get<double>(), 1.5e-4, 2e-6);
}

TEST_F(RecordedPluck, IsRefusedWhereItsNumbersOrItsDecayAreWrong) {
  write_pluck({});
  StudyResult result = run("pluck.csv", "fundamental: 98 Hz\n");
  EXPECT_EQ(result.status, report::Status::kFailed);
  EXPECT_THAT(result.answer, HasSubstr("a multiple of 2"));
  EXPECT_THAT(result.answer, HasSubstr("state fundamental: 196 Hz"));
  result = run("pluck.csv", "fundamental: 392 Hz\n");
  EXPECT_EQ(result.status, report::Status::kFailed);
  // A bowed string does not decay.
  result = run(MODCAL_EXAMPLES "/bowed_violin_d.csv", "fundamental: 294 Hz\n");
  EXPECT_EQ(result.status, report::Status::kFailed);
  EXPECT_THAT(result.answer, HasSubstr("rejected"));
}

TEST_F(RecordedPluck, ThatMovesInTwoPlanesHasTheLargerWithinItsErrorBars) {
  write_pluck({.split = 2e-3});
  const StudyResult result = run("pluck.csv", kLowModes);
  ASSERT_EQ(result.status, report::Status::kOk) << result.answer;
  EXPECT_THAT(result.summary, HasSubstr("modes have a second pole"));
  const auto document = nlohmann::json::parse(result.files.at(0).second);
  ASSERT_EQ(document["modes"].size(), 4u);
  EXPECT_EQ(document["with_second_pole"].size(), 4u);
  EXPECT_LT(mean_square(document, 1.0), 3.0);
}

// Each mode glides by a thousandth while the first decays, as where it swings wide.
TEST_F(RecordedPluck, ThatGlidesIsRefused) {
  write_pluck({.glide = 1e-3});
  const StudyResult result = run("pluck.csv", kLowModes);
  EXPECT_EQ(result.status, report::Status::kFailed);
  EXPECT_THAT(result.answer, HasSubstr("the frequency or the damping changes along the decay"));
}

TEST_F(RecordedPluck, HasHumOfTheMainsBesideItsModes) {
  write_pluck({.hum = 0.05});
  const StudyResult result = run("pluck.csv", "fundamental: 197 Hz\n");
  ASSERT_EQ(result.status, report::Status::kOk) << result.answer;
  EXPECT_THAT(result.summary, HasSubstr("hum of the mains at 50.0"));
  const auto document = nlohmann::json::parse(result.files.at(0).second);
  ASSERT_EQ(document["modes"].size(), 11u);
  // σ_F of the first line alone: √6 σ/(π T A √N) = √6 .2/(π 1.2 √24000) = 8e-4 Hz.
  EXPECT_NEAR(document["mains_lines_hz"].at(0).get<double>(), kMains, 4e-3);
  EXPECT_LT(mean_square(document, 1.0), 2.2);  // 22 squares, as above
}

// Well before 1 s the string moves by less than four steps, and what they round off follows it.
TEST_F(RecordedPluck, IsUsedAsFarAsItsStepsResolveIt) {
  const double faster = 5.0;
  write_pluck({.step = 0.1, .faster = faster});
  const StudyResult result = run("pluck.csv", "fundamental: 197 Hz\n");
  ASSERT_EQ(result.status, report::Status::kOk) << result.answer;
  EXPECT_THAT(result.warnings,
              testing::Contains(HasSubstr("less than four of the record's steps")));
  const auto document = nlohmann::json::parse(result.files.at(0).second);
  EXPECT_LT(document["end_s"].get<double>(), 1.0);
  ASSERT_GE(document["modes"].size(), 4u);
  // The mean of 8 squared standard normal numbers is 1 ± .5.
  EXPECT_LT(mean_square(document, faster), 2.5);
}

// Less than four steps throughout.
TEST_F(RecordedPluck, OfTooFewStepsIsRefused) {
  write_pluck({.step = 1.5});
  EXPECT_THROW(run("pluck.csv", "fundamental: 197 Hz\n"), InvalidInput);
}

TEST_F(RecordedPluck, NeedsItsFundamentalAndARecordOrAScene) {
  write_pluck({});
  const auto said = [&](const std::string& text) {
    write("wrong.yaml", "kind: identify\n" + text);
    const LoadedExperiment loaded = load_experiment(path("wrong.yaml"));
    return format_mistakes(loaded.document, loaded.mistakes);
  };
  EXPECT_THAT(said("seed: 1\n"), HasSubstr("state a scene (simulated), the record of a string"));
  EXPECT_THAT(said("record: {file: pluck.csv, left: {channel: R1}}\n"),
              HasSubstr("state fundamental: ... Hz"));
  EXPECT_THAT(said("record: {file: pluck.csv, left: {channel: R1}}\nfundamental: 3000 Hz\n"),
              HasSubstr("no mode lies below 2300 Hz"));
}

}  // namespace
}  // namespace modcal::identify_record_test
