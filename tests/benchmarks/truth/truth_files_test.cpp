// Records of the truth as modcal reads them, and what is said to be true of them.
#include "benchmarks/truth/truth_files.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "libsim/records/recording.hpp"
#include "tests/folder_test.hpp"

namespace modcal::truth::truth_files_test {
namespace {

using nlohmann::json;

class TruthFiles : public FolderTest {
 protected:
  json truth_of(const std::string& name) const {
    std::ifstream file(path(name));
    return json::parse(file);
  }
};

TEST_F(TruthFiles, AreRecordsThatModcalReads) {
  const TruthString string;
  const TruthGesture gesture{.action = TruthBow{.friction = ThermalFriction{}}};
  for (const double rate : {51200.0, 44100.0}) {
    TruthOptions options{.duration = 0.02, .sample_rate = rate, .noise_level = 0.01, .seed = 3};
    options.least_rate = 2e6;
    const TruthRecord record = simulate(string, gesture, options);
    write_record(path("r.csv"), record);
    RecordOptions channels{.file = "r.csv", .has_left = true, .has_right = true};
    channels.left.channel = "R1";
    channels.right.channel = "R2";
    channels.has_reference = true;
    channels.reference.channel = "f_c";
    const RecordedSignals read = load_record(channels, folder());
    EXPECT_EQ(read.sample_rate, rate);
    EXPECT_TRUE(read.warnings.empty());
    ASSERT_EQ(read.size(), static_cast<std::size_t>(std::llround(0.02 * rate)));
    for (std::size_t i = 0; i < read.size(); ++i) {
      EXPECT_NEAR(read.left->samples[i], record.r1[i], 1e-11 * std::abs(record.r1[i]));
      EXPECT_NEAR(read.right->samples[i], record.r2[i], 1e-11 * std::abs(record.r2[i]));
      EXPECT_NEAR(read.reference->samples[i], record.f[i], 1e-11 * std::abs(record.f[i]));
    }
  }
}

TEST_F(TruthFiles, SayWhatIsTrue) {
  TruthString string;
  string.torsion.emplace();
  const TruthGesture gesture{.position = 0.05, .action = TruthForce{}};
  TruthOptions options{.duration = 0.01, .reactions = Reactions::kSupport};
  options.least_rate = 2e6;
  const TruthRecord record = simulate(string, gesture, options);
  write_truth(path("r.json"), string, gesture, options, record);
  const json truth = truth_of("r.json");
  EXPECT_EQ(truth["string"]["f0"], string.fundamental);
  EXPECT_EQ(truth["string"]["B"], string.inharmonicity);
  EXPECT_EQ(truth["string"]["T"], string.tension());
  EXPECT_EQ(truth["string"]["damping"]["s1"], string.diffusion);
  EXPECT_EQ(truth["string"]["torsion"]["speed_ratio"], 5.2);
  EXPECT_EQ(truth["x_c"], 0.05);
  EXPECT_EQ(truth["gesture"]["type"], "force");
  EXPECT_EQ(truth["reactions"]["bending"], true);
  EXPECT_EQ(truth["reactions"]["boundary_damping"], false);
  EXPECT_EQ(truth["record"]["rate"], 51200.0);
  ASSERT_EQ(truth["modes"]["f"].size(), record.modes.size());
  EXPECT_EQ(truth["modes"]["f"][9], record.modes[9].omega / (2.0 * std::numbers::pi));
  EXPECT_EQ(truth["modes"]["zeta"][9], record.modes[9].decay / record.modes[9].omega);
}

TEST_F(TruthFiles, RefuseWhatCannotBeWritten) {
  EXPECT_THROW(write_record(path("no/such/folder.csv"), {}), std::runtime_error);
}

}  // namespace
}  // namespace modcal::truth::truth_files_test
