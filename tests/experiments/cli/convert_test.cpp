#include <fmt/format.h>
#include <gmock/gmock.h>

#include "libsim/records/formats.hpp"
#include "tests/experiments/cli/program_run.hpp"

namespace modcal::convert_test {
namespace {

using ::testing::ContainsRegex;
using ::testing::HasSubstr;

class Convert : public testing::ProgramTest {
 protected:
  Convert() {
    write_csv(path("a.csv"), std::vector<Signal>{{"R1", "N", 51200.0, {0.1, 1.0 / 3.0, -2e-300}},
                                                 {"a_1", "m/s2", 51200.0, {1e10, 0.7, 0.0}}});
  }
};

TEST_F(Convert, EveryFormatKeepsEveryBit) {
  const Recording first = read_record(path("a.csv"), "auto");
  for (const RecordFormat& format : record_formats()) {
    if (format.write == nullptr) continue;
    const std::string name = fmt::format("b{}", format.extensions.front());
    const Outcome converted = modcal(fmt::format("convert a.csv {}", name));
    ASSERT_EQ(converted.code, 0) << converted.err;
    const Recording second = read_record(path(name), "auto");
    EXPECT_EQ(second.sample_rate, first.sample_rate) << name;
    ASSERT_EQ(second.channels.size(), 2u) << name;
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(second.channels[i].name, first.channels[i].name);
      EXPECT_EQ(second.channels[i].unit, first.channels[i].unit);
      EXPECT_EQ(second.channels[i].samples, first.channels[i].samples) << name;
    }
  }
}

TEST_F(Convert, WhatStandsThereIsNeverReplaced) {
  write("mine.uff", "mine");
  const Outcome refused = modcal("convert a.csv mine.uff");
  EXPECT_EQ(refused.code, 3);
  EXPECT_THAT(refused.err, HasSubstr("is not replaced"));
  EXPECT_EQ(content_of(path("mine.uff")), "mine");
  EXPECT_EQ(modcal("convert a.csv a.csv").code, 3);
}

TEST_F(Convert, AKilledConversionLeavesNothingBehindTheNext) {
  // What SIGKILL leaves, a while ago; of other files nothing is ours to remove.
  for (const char* name : {"b.csv.0badcafe.part", "other.csv.0badcafe.part"}) {
    write(name, "half");
    std::filesystem::last_write_time(
        path(name), std::filesystem::file_time_type::clock::now() - std::chrono::minutes(1));
  }
  ASSERT_EQ(modcal("convert a.csv b.csv").code, 0);
  EXPECT_FALSE(std::filesystem::exists(path("b.csv.0badcafe.part")));
  EXPECT_TRUE(std::filesystem::exists(path("other.csv.0badcafe.part")));
}

TEST_F(Convert, HeadersAloneTellChannelsAndRate) {
  ASSERT_EQ(modcal("convert a.csv b.uff").code, 0);
  const Outcome inspected = modcal("inspect b.uff --headers");
  EXPECT_EQ(inspected.code, 0) << inspected.err;
  EXPECT_THAT(inspected.out, HasSubstr("2 channels, 3 samples at 51200 Hz"));
  EXPECT_THAT(inspected.out, HasSubstr("a_1 [m/s2], acceleration\n"));
  EXPECT_THAT(inspected.out, HasSubstr("headers alone were read"));
  EXPECT_THAT(inspected.out, HasSubstr("file: \"b.uff\""));
}

TEST_F(Convert, ADamagedFileIsRefusedWithItsPlace) {
  ASSERT_EQ(modcal("convert a.csv b.uff").code, 0);
  const std::string cut = content_of(path("b.uff")).substr(0, 700);
  write("c.uff", cut);
  const Outcome refused = modcal("inspect c.uff");
  EXPECT_EQ(refused.code, 3);
  // The header holds the path of the folder, so the line of a byte depends on where the tests run.
  EXPECT_THAT(refused.err, ContainsRegex("c[.]uff:[0-9]+: dataset 58b: the file ends at byte 700"));
}

}  // namespace
}  // namespace modcal::convert_test
