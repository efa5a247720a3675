#include "experiments/records/inspection.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <numbers>

#include "libsim/base/random.hpp"
#include "libsim/records/record_file.hpp"
#include "libsim/records/recording.hpp"
#include "tests/folder_test.hpp"

namespace modcal::inspection_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class Inspect : public FolderTest {};

constexpr double kRate = 51200.0;

std::vector<double> noisy_sine(double amplitude, double noise, double offset, std::size_t size) {
  std::vector<double> samples(size);
  fill_standard_normal(StreamKey(7), samples);
  for (std::size_t i = 0; i < size; ++i) {
    const double phase = 2 * std::numbers::pi * 440.3 * static_cast<double>(i) / kRate;
    samples[i] = offset + noise * samples[i] + amplitude * std::sin(phase);
  }
  return samples;
}

// The band holds n = 0.35 K/2 exponentially distributed powers. Their median has the relative
// standard deviation 1/(ln 2 √n); a Hann window correlates powers of neighbors by 4/9 and of next
// neighbors by 1/36, which raises the variance by 1 + 2 (4/9 + 1/36) = 1.94. The rms value has half
// of it. Five of these.
double noise_tolerance(std::size_t size) {
  const double bins = 0.35 * static_cast<double>(size) / 2.0;
  return 5.0 * 0.5 * std::sqrt(1.94 / bins) / std::numbers::ln2;
}

TEST_F(Inspect, MeasuresTheNoiseOfANoisySine) {
  for (const std::size_t size : {std::size_t{51200}, std::size_t{10007}}) {
    for (const double noise : {0.0, 1e-4, 0.05}) {
      const double estimate = white_noise_rms(noisy_sine(1.0, noise, 3.0, size));
      // Beside the noise: the sine's leakage, (bins away)^-3 ~ 1e-9 of its amplitude.
      EXPECT_NEAR(estimate, noise, noise_tolerance(size) * noise + 1e-9) << size;
    }
  }
}

TEST_F(Inspect, ReportsLevelsOfEveryChannel) {
  const std::vector<Signal> signals{{"R2", "N", kRate, noisy_sine(1.0, 0.05, 0.25, 51200)},
                                    {"R1", "N", kRate, noisy_sine(0.5, 0.0, 0.0, 51200)}};
  write_csv(path("r.csv"), signals);
  const InspectionReport report = inspect(path("r.csv"));
  EXPECT_EQ(report.sample_rate, kRate);
  EXPECT_EQ(report.frames, 51200u);
  EXPECT_THAT(report.problems, IsEmpty());
  ASSERT_EQ(report.channels.size(), 2u);
  const Levels& levels = report.channels[0].levels;
  // 440.3 periods: the last 0.3 shift mean and power by up to 1/(2π 440) = 4e-4; noise: the mean
  // by 5·0.05/√51200 = 1.1e-3.
  EXPECT_NEAR(levels.mean, 0.25, 1.5e-3);
  EXPECT_NEAR(levels.std, std::sqrt(0.5 + 0.05 * 0.05), 1.5e-3);
  EXPECT_NEAR(levels.rms, std::hypot(levels.mean, levels.std), 1e-12);
  EXPECT_GT(levels.peak, 1.25);
  EXPECT_EQ(report.channels[0].clipping.runs, 0u);
  EXPECT_NEAR(report.channels[0].noise_rms, 0.05, 0.05 * noise_tolerance(51200));
  EXPECT_EQ(report.record.left.channel, "R1");
  EXPECT_EQ(report.record.right.channel, "R2");
  EXPECT_THAT(text(report), HasSubstr("2 channels, 51200 samples at 51200 Hz"));
  EXPECT_THAT(text(report), HasSubstr("noise is taken to be white"));
  const auto object = json(report);
  EXPECT_EQ(object["channels"][1]["name"], "R1");
  EXPECT_EQ(object["samples"], 51200);
}

TEST_F(Inspect, FindsClipping) {
  std::vector<double> samples = noisy_sine(1.0, 0.0, 0.0, 5120);
  std::size_t beyond = 0;
  for (double& value : samples) {
    if (std::abs(value) >= 0.9) ++beyond;
    value = std::clamp(value, -0.9, 0.9);
  }
  const Clipping clipping = find_clipping(samples);
  // 0.1 s of 440.3 Hz: 44 crests and 44 troughs, all longer than three samples.
  EXPECT_EQ(clipping.runs, 88u);
  EXPECT_EQ(clipping.samples, beyond);
  EXPECT_EQ(find_clipping(noisy_sine(1.0, 1e-3, 0.0, 5120)).runs, 0u);
  EXPECT_EQ(find_clipping(std::vector<double>(100, 1.0)).runs, 0u);
  EXPECT_EQ(find_clipping({}).runs, 0u);
}

TEST_F(Inspect, TakesRestAtZeroForNoClipping) {
  std::vector<double> samples(10000, 0.0);
  for (std::size_t i = 0; i < 10; ++i) samples[300 + i] = static_cast<double>(1 + i);
  EXPECT_EQ(find_clipping(samples).runs, 0u);
  // What is cut there comes back.
  std::vector<double> cut = noisy_sine(1.0, 0.0, 0.3, 5120);
  for (double& value : cut) value = std::max(value, 0.0);
  EXPECT_GT(find_clipping(cut).runs, 40u);
  // And when the signal has died away it looks like rest.
  cut.resize(2 * cut.size(), 0.0);
  EXPECT_GT(find_clipping(cut).runs, 40u);
}

TEST_F(Inspect, TakesNoSignalOfFewStepsForClipped) {
  std::vector<double> samples = noisy_sine(1.0, 0.0, 0.0, 5120);
  for (double& value : samples) value = std::round(5.0 * value);
  EXPECT_EQ(find_clipping(samples).runs, 0u);
  for (double& value : samples) value = std::clamp(value, -3.0, 3.0);
  EXPECT_GT(find_clipping(samples).runs, 0u);
}

TEST_F(Inspect, ListsWhatARunWouldRefuse) {
  const auto file = write("r.csv", "t,R1 [N],R2 [N]\n0,1,2\n1,nan,3\n2,x,1\n");
  const InspectionReport report = inspect(file);
  EXPECT_EQ(report.problem_count, 2u);
  EXPECT_EQ(report.channels[0].levels.not_finite, 2u);
  EXPECT_EQ(report.channels[0].levels.first_not_finite, 1u);
  EXPECT_THAT(text(report), HasSubstr("A run would refuse this file:"));
  EXPECT_THAT(text(report), HasSubstr("2 samples are no numbers, first sample 1"));
  EXPECT_TRUE(json(report)["channels"][0]["noise_rms"].is_null());
}

TEST_F(Inspect, ListsSamplesThatARunWouldRefuse) {
  std::vector<double> clipped = noisy_sine(1.0, 1e-3, 0.0, 5120);
  for (double& value : clipped) value = std::min(value, 0.9);
  write_csv(path("r.csv"), std::vector<Signal>{{"R1", "N", kRate, clipped},
                                               {"R2", "N", kRate, noisy_sine(1.0, 1e-3, 0.0, 5120)},
                                               {"trigger", "V", kRate, clipped}});
  const InspectionReport report = inspect(path("r.csv"));
  EXPECT_EQ(report.problem_count, 1u);
  EXPECT_THAT(report.problems, ElementsAre(testing::AllOf(HasSubstr("channel R1, sample"),
                                                          HasSubstr("the peaks are clipped"))));
}

TEST_F(Inspect, ReportsOneSampleWithoutAKnownRate) {
  const InspectionReport report = inspect(write("r.csv", "t,R1 [N]\n0,2\n"));
  EXPECT_TRUE(std::isnan(report.sample_rate));
  EXPECT_EQ(report.channels[0].levels.peak, 2.0);
  EXPECT_THAT(text(report), HasSubstr("1 channel, 1 samples at unknown Hz"));
  EXPECT_TRUE(json(report)["sample_rate"].is_null());
}

TEST_F(Inspect, ShowsNonUniformSampling) {
  const InspectionReport report =
      inspect(write("r.csv", "t,R1 [N]\n0.00,1\n0.10,2\n0.20,3\n0.50,1\n0.60,0\n"));
  EXPECT_THAT(report.problems, ElementsAre(HasSubstr("r.csv:5: sample 3: a gap of 0.3 s")));
}

TEST_F(Inspect, ScalesWavChannelsThatStateTheirScale) {
  const std::vector<Signal> signals{{"R1", "N", kRate, {2.0, -4.0}}};
  write_wav(path("r.wav"), signals, {.samples = WavSamples::kPcm24, .full_scale = 8.0});
  const InspectionReport report = inspect(path("r.wav"));
  EXPECT_EQ(report.channels[0].levels.peak, 4.0);
  EXPECT_EQ(report.channels[0].unit, "N");
  EXPECT_EQ(report.format, "WAV (Microsoft), Signed 24 bit PCM");
}

TEST_F(Inspect, ProposesAnExperiment) {
  const auto file = write("a: \"b\" #1.csv", "t,a [V],f_c [N],- b: #2 [mN]\n0,1,2,3\n1,1,2,3\n");
  const InspectionReport report = inspect(file);
  EXPECT_THAT(report.warnings, ElementsAre(HasSubstr("fill in record.left.calibration")));
  const YAML::Node yaml = YAML::Load(stanza(report));
  const YAML::Node record = yaml["record"];
  EXPECT_EQ(yaml["kind"].as<std::string>(), "invert");
  EXPECT_EQ(record["file"].as<std::string>(), file.string());
  EXPECT_EQ(record["format"].as<std::string>(), "auto");
  EXPECT_EQ(record["left"]["channel"].as<std::string>(), "a");
  EXPECT_EQ(record["left"]["calibration"].as<std::string>(), "1 N");  // volts: to be filled in
  EXPECT_EQ(record["right"]["channel"].as<std::string>(), "- b: #2");
  EXPECT_EQ(record["right"]["calibration"].as<std::string>(), "file");
  EXPECT_EQ(record["reference"]["channel"].as<std::string>(), "f_c");
  EXPECT_EQ(record["stop"].as<std::string>(), "end");
  EXPECT_TRUE(yaml["string"]["length"].IsNull());  // only the user knows
  EXPECT_EQ(yaml["string"]["damping"]["type"].as<std::string>(), "constant");
  EXPECT_TRUE(yaml["bow"]["position"].IsNull());
}

TEST_F(Inspect, ProposesTheOnlyOtherForceWhereOneReactionIsNamed) {
  const auto file = write("r.csv", "t,R2 [N],other [N],v [m/s]\n0,1,1,1\n1,2,3,2\n");
  const InspectionReport two = inspect(file);
  const YAML::Node record = YAML::Load(stanza(two))["record"];
  EXPECT_EQ(record["left"]["channel"].as<std::string>(), "other");
  EXPECT_EQ(record["right"]["channel"].as<std::string>(), "R2");
  EXPECT_THAT(two.warnings, ElementsAre(HasSubstr("leave record.left out if it is none")));
  // Which of two it would be nobody knows.
  const auto three = write("r.csv", "t,R2 [N],other [N],bow [N]\n0,1,1,1\n1,2,3,2\n");
  EXPECT_FALSE(YAML::Load(stanza(inspect(three)))["record"]["left"].IsDefined());
}

TEST_F(Inspect, ProposesByUnitsWhereNamesSayNothing) {
  const auto file = write("r.csv",
                          "time/ms,temp [degC],v [mm/s],bow [m/s],bridge/mN,nut [N]\n"
                          "0,20,3,4,2,6\n1,21,4,5,4,9\n2,21,2,5,8,9\n");
  const InspectionReport report = inspect(file);
  const YAML::Node record = YAML::Load(stanza(report))["record"];
  EXPECT_EQ(record["left"]["channel"].as<std::string>(), "bridge");
  EXPECT_EQ(record["right"]["channel"].as<std::string>(), "nut");
  EXPECT_EQ(record["reference_velocity"]["channel"].as<std::string>(), "v");
  EXPECT_FALSE(record["reference"].IsDefined());
  const RecordedSignals loaded = load_record(report.record, "");
  EXPECT_THAT(loaded.left->samples, ElementsAre(2e-3, 4e-3, 8e-3));
  EXPECT_THAT(loaded.reference_velocity->samples, ElementsAre(3e-3, 4e-3, 2e-3));
  // One force alone: what moves is no reaction.
  const auto one = write("one.csv", "t,x [mm],F [N]\n0,1,1\n1,2,2\n");
  const YAML::Node other = YAML::Load(stanza(inspect(one)))["record"];
  EXPECT_EQ(other["left"]["channel"].as<std::string>(), "F");
  EXPECT_FALSE(other["right"].IsDefined());
}

TEST_F(Inspect, ProposesModesOfAStrikeAndAForceByThem) {
  // A hammer stands alone in its channel, which is no fault; a response does not.
  std::vector<double> blow(64, 0.0), spike(64), sine(64), moved(64);
  blow[9] = 40.0;
  for (std::size_t i = 0; i < 64; ++i) {
    sine[i] = spike[i] = std::sin(0.7 * static_cast<double>(i));
    moved[i] = -2.0 * sine[i];
  }
  const std::vector<Signal> signals{
      {"hammer", "N", 1e3, blow}, {"a 1", "m/s2", 1e3, sine}, {"y", "m", 1e3, moved}};
  write_csv(path("strike.csv"), signals);
  const InspectionReport strike = inspect(path("strike.csv"));
  EXPECT_THAT(strike.problems, IsEmpty());
  const YAML::Node modes = YAML::Load(stanza(strike));
  EXPECT_EQ(modes["kind"].as<std::string>(), "fit_modes");
  EXPECT_EQ(modes["record"]["force"]["channel"].as<std::string>(), "hammer");
  EXPECT_EQ(modes["record"]["responses"][0]["channel"].as<std::string>(), "a 1");
  EXPECT_EQ(modes["record"]["responses"][1]["kind"].as<std::string>(), "displacement");
  EXPECT_TRUE(modes["low"].IsNull());
  spike[30] = 40.0;
  write_csv(path("moves.csv"), std::vector<Signal>{{"a 1", "m/s2", 1e3, spike}});
  const InspectionReport moves = inspect(path("moves.csv"));
  EXPECT_THAT(moves.problems, ElementsAre(HasSubstr("channel a 1, sample 30")));
  EXPECT_EQ(YAML::Load(stanza(moves))["kind"].as<std::string>(), "identify_force");
  write_csv(path("copy.csv"),
            std::vector<Signal>{
                {"a 1", "m/s2", 1e3, sine}, {"f", "N", 1e3, blow}, {"a 2", "m/s2", 1e3, sine}});
  EXPECT_THAT(inspect(path("copy.csv")).problems,
              ElementsAre(HasSubstr("channels a 1 and a 2 are one signal")));
}

TEST_F(Inspect, ProposesModesOfResponseFunctions) {
  write("f.csv",
        "frequency [Hz],h1 [g/lbf],h1 imaginary [g/lbf],c1\n0,1,0,1\n0.5,2,1,1\n1,3,2,0.9\n");
  const InspectionReport report = inspect(path("f.csv"));
  EXPECT_THAT(report.problems, IsEmpty());
  EXPECT_THAT(text(report), HasSubstr("2 functions of frequency, 3 lines from 0 to 1 Hz"));
  EXPECT_THAT(text(report), HasSubstr("h1 [g/lbf], response function"));
  const YAML::Node modes = YAML::Load(stanza(report));
  EXPECT_EQ(modes["kind"].as<std::string>(), "fit_modes");
  ASSERT_EQ(modes["functions"]["responses"].size(), 1u);
  EXPECT_EQ(modes["functions"]["responses"][0]["channel"].as<std::string>(), "h1");
  // A rate that is stated is one of a record in time.
  EXPECT_FALSE(inspect(path("f.csv"), {.sample_rate = 1e3}).functions);
}

TEST_F(Inspect, ProposalLoadsAsItStands) {
  const std::vector<Signal> signals{{"x", "mN", kRate, {1.0, 2.0, 4.0}},
                                    {"y", "N", kRate, {3.0, 4.0, 5.0}}};
  write_csv(path("r.csv"), signals);
  const RecordedSignals loaded = load_record(inspect(path("r.csv")).record, "");
  EXPECT_THAT(loaded.left->samples, ElementsAre(1e-3, 2e-3, 4e-3));
  EXPECT_EQ(loaded.right->samples, signals[1].samples);
}

}  // namespace
}  // namespace modcal::inspection_test
