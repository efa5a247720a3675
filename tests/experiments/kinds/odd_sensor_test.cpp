// One sensor that contradicts the others: left out, or refused by name where they are too few.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>

#include "libsim/records/record_file.hpp"
#include "tests/experiments/kinds/structure_config.hpp"
#include "tests/folder_test.hpp"

namespace modcal::odd_sensor_test {
namespace {

using structure_config::file_of, structure_config::kFolder, structure_config::run;
using testing::HasSubstr;
using testing::Not;
using Samples = std::vector<double>;

class OddSensor : public FolderTest {
 protected:
  // The other strike of configs/ with its second response changed.
  std::string spoilt(const std::function<void(Samples&)>& change) const {
    Recording strike = read_csv(kFolder + "plate_other_strike.csv");
    change(strike.channels[2].samples);
    std::string text =
        "# sample_rate: 4000 Hz\nforce [N],a1 [m/s2],a2 [m/s2],a3 [m/s2],a4 [m/s2]\n";
    for (std::size_t j = 0; j < strike.channels[0].samples.size(); ++j) {
      for (std::size_t k = 0; k < 5; ++k) {
        text += fmt::format("{:.9g}{}", strike.channels[k].samples[j], k < 4 ? "," : "\n");
      }
    }
    return "record.file=" + write("record.csv", text).string();
  }
};

double error_of(const StudyResult& result) {
  return file_of(result, "force.json")["force"][0]["relative_error"].get<double>();
}

void drop_samples(Samples& a) { std::rotate(a.begin() + 90, a.begin() + 93, a.end()); }
void double_gain(Samples& a) {
  for (double& x : a) x *= 2.0;
}
void turn_sign(Samples& a) {
  for (double& x : a) x = -x;
}

// In responses that are no larger than the noise of the table nothing contradicts.
TEST_F(OddSensor, IsNoneWhereNoForceIsTold) {
  Recording strike = read_csv(kFolder + "plate_other_strike.csv");
  std::string text = "# sample_rate: 4000 Hz\nforce [N],a1 [m/s2],a2 [m/s2],a3 [m/s2],a4 [m/s2]\n";
  for (std::size_t j = 0; j < strike.channels[0].samples.size(); ++j) {
    for (std::size_t k = 0; k < 5; ++k) {
      const double gain = k == 0 ? 1.0 : k == 2 ? 3e-20 : 1e-20;
      text += fmt::format("{:.9g}{}", gain * strike.channels[k].samples[j], k < 4 ? "," : "\n");
    }
  }
  const StudyResult quiet =
      run("force_on_plate.yaml", {"record.file=" + write("record.csv", text).string()});
  EXPECT_TRUE(file_of(quiet, "force.json")["left_out"].is_null());
  EXPECT_THAT(quiet.summary, Not(HasSubstr("contradicts")));
  // A wrong unit would leave a force of 0 with a narrow band.
  EXPECT_EQ(quiet.status, report::Status::kFailed);
  EXPECT_THAT(quiet.answer, HasSubstr("the responses tell no force"));
}

// Three sensors find the force as well as four do.
TEST_F(OddSensor, OfFourIsLeftOutAndNamed) {
  const StudyResult whole = run("force_on_plate.yaml", {spoilt([](Samples&) {})});
  EXPECT_THAT(whole.summary, Not(HasSubstr("a2")));
  EXPECT_TRUE(file_of(whole, "force.json")["left_out"].is_null());
  for (const auto& change : {drop_samples, double_gain, turn_sign}) {
    const StudyResult result = run("force_on_plate.yaml", {spoilt(change)});
    EXPECT_EQ(result.status, report::Status::kOk);
    EXPECT_THAT(result.summary, HasSubstr("impacts from 3 sensors"));
    EXPECT_THAT(result.summary, HasSubstr("a2 contradicts the other sensors, which agree without "
                                          "it: it is left out"));
    EXPECT_EQ(file_of(result, "force.json")["left_out"], "a2");
    EXPECT_NEAR(error_of(result), error_of(whole), 0.2 * error_of(whole));
  }
}

// Two of three may agree by chance: no answer.
TEST_F(OddSensor, OfThreeIsRefusedByName) {
  const std::string three = "record.responses=[{channel: a1}, {channel: a2}, {channel: a3}]";
  for (const auto& [file, text] : run("fit_plate.yaml", {three}).files) write(file, text);
  const StudyResult result = run(
      "force_on_plate.yaml", {three, "table=" + path("table.yaml").string(), spoilt(drop_samples)});
  EXPECT_EQ(result.status, report::Status::kFailed);
  EXPECT_THAT(result.answer, HasSubstr("rejected: a2 contradicts the other sensors, which agree"));
}

}  // namespace
}  // namespace modcal::odd_sensor_test
