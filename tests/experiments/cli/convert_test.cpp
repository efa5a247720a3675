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

// The instant of the first sample, where the format has a place for it; a sound file has none.
TEST_F(Convert, ARecordBeginsWhereItBegan) {
  write("late.csv", "t [s],R1 [N]\n-0.125,1\n-0.124,2\n-0.123,4\n");
  for (const RecordFormat& format : record_formats()) {
    const std::string name = fmt::format("late{}", format.extensions.back());
    const Outcome converted = modcal("convert late.csv " + name);
    ASSERT_EQ(converted.code, 0) << converted.err;
    const Recording read = read_record(path(name), "auto");
    EXPECT_EQ(read.sample_rate, 1000.0) << name;
    EXPECT_EQ(read.start, format.begins_at_zero ? 0.0 : -0.125) << name;
    EXPECT_EQ(converted.err.find("begins at -0.125 s") != std::string::npos, format.begins_at_zero);
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

// A block is 1 kB here; the record takes at least 16 in every format.
TEST_F(Convert, AFullDiskLeavesNoFile) {
  shell(
      "awk 'BEGIN {print \"# sample_rate: 1000 Hz\\nR1 [N],R2 [N]\"; for (i = 0; i < 4000; ++i) "
      "print i % 7 + 1 / 3 \",\" i % 11}' > whole.csv");
  for (const char* format : {"csv", "wav", "uff", "npy", "npz", "h5", "lvm", "mat"}) {
    for (const int blocks : {1, 8, 31}) {
      const Outcome outcome = shell(fmt::format("trap '' XFSZ; ulimit -f {}; '" MODCAL_PROGRAM
                                                "' convert whole.csv full.{}",
                                                blocks, format));
      const bool is_there = std::filesystem::exists(folder() / (std::string("full.") + format));
      EXPECT_EQ(outcome.code, is_there ? 0 : 3) << format << ' ' << blocks << outcome.err;
      // What is said to be written is all of it.
      if (is_there) {
        EXPECT_EQ(modcal(std::string("inspect full.") + format).code, 0) << format;
        EXPECT_THAT(modcal(std::string("inspect full.") + format).out, HasSubstr("4000 samples"));
      } else {
        EXPECT_THAT(outcome.err, HasSubstr(std::string("full.") + format)) << outcome.err;
      }
      std::filesystem::remove(folder() / (std::string("full.") + format));
    }
  }
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

// The library had crashed at the program's end, on what it had opened of the file.
TEST_F(Convert, ADamagedHeaderOfHdf5IsRefusedOnce) {
  ASSERT_EQ(modcal("convert a.csv b.h5").code, 0);
  std::string content = content_of(path("b.h5"));
  // Version, rank and flags of a simple dataspace of 3 samples.
  const std::string space("\x01\x01\x01\0\0\0\0\0\x03\0\0\0\0\0\0\0", 16);
  const std::size_t at = content.rfind(space);
  ASSERT_NE(at, std::string::npos);
  content[at] = 9;
  write("c.h5", content);
  const Outcome refused = modcal("inspect c.h5");
  EXPECT_EQ(refused.code, 3);
  EXPECT_THAT(refused.err, HasSubstr("the file is damaged"));
}

const char* const kFunctions =
    "frequency [Hz],h1 [m/s2/N],h1 imaginary [m/s2/N],c1\n0,1,0,1\n0.1,0.5,-1e-3,0.9\n"
    "0.2,0.3333333333333333,7,0.8\n0.30000000000000004,2,3,1\n";

TEST_F(Convert, FunctionsOfFrequencyKeepEveryBitInEveryFormat) {
  write("f.csv", kFunctions);
  const FileFunctions first = read_functions(path("f.csv"), "auto");
  std::string from = "f.csv";
  for (const std::string to : {"f.uff", "f.mat", "f.npz", "f.h5", "back.csv"}) {
    const Outcome converted = modcal(fmt::format("convert {} {}", from, to));
    ASSERT_EQ(converted.code, 0) << converted.err;
    EXPECT_EQ(converted.err, "") << to;
    EXPECT_THAT(converted.out,
                HasSubstr(to + ": 2 functions of frequency, 4 lines from 0 to 0.3 Hz"));
    const FileFunctions read = read_functions(path(to), "auto");
    ASSERT_EQ(read.functions.size(), 2u) << to;
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(read.functions[i].name, first.functions[i].name) << to;
      EXPECT_EQ(read.functions[i].unit, first.functions[i].unit) << to;
      EXPECT_EQ(read.functions[i].what, first.functions[i].what) << to;
      EXPECT_EQ(read.functions[i].hertz, first.functions[i].hertz) << to;
      EXPECT_EQ(read.functions[i].values, first.functions[i].values) << to;
    }
    from = to;
  }
}

TEST_F(Convert, FunctionsOfFrequencyAreNoSound) {
  write("f.csv", kFunctions);
  for (const char* to : {"f.wav", "f.lvm", "f.npy"}) {
    const Outcome refused = modcal(fmt::format("convert f.csv {}", to));
    EXPECT_EQ(refused.code, 3);
    EXPECT_THAT(refused.err, HasSubstr("these formats hold them: csv, uff, mat, npz, hdf5"));
    EXPECT_FALSE(std::filesystem::exists(path(to)));
  }
}

TEST_F(Convert, ARecordInTimeGoesBeforeFunctions) {
  write("f.csv", kFunctions);
  ASSERT_EQ(modcal("convert f.csv f.uff").code, 0);
  ASSERT_EQ(modcal("convert a.csv a.uff").code, 0);
  write("both.uff", content_of(path("f.uff")) + content_of(path("a.uff")));
  const Outcome both = modcal("convert both.uff both.mat");
  EXPECT_EQ(both.code, 0) << both.err;
  EXPECT_THAT(both.out, HasSubstr("2 channels, 3 samples at 51200 Hz"));
  EXPECT_THAT(both.err, HasSubstr("\"h1\" [m/s2] is left out: complex frequency response"));
}

TEST_F(Convert, AFileWithoutEitherAsksForTheRate) {
  write("x.csv", "f [N],x [m]\n1,2\n3,4\n4,5\n");
  const Outcome refused = modcal("convert x.csv x.mat");
  EXPECT_EQ(refused.code, 3);
  EXPECT_THAT(refused.err, HasSubstr("the sample rate is not known; state --sample-rate"));
}

TEST_F(Convert, NewNamesTheOptionOfTheRate) {
  write("x.csv", "R1 [N],R2 [N]\n1,2\n3,4\n4,5\n");
  const Outcome refused = modcal("new invert x.csv");
  EXPECT_EQ(refused.code, 3);
  EXPECT_THAT(refused.err, HasSubstr("the sample rate is not known; state --sample-rate, add"));
}

TEST_F(Convert, UnevenInstantsSayWhatToDo) {
  ASSERT_EQ(modcal("convert a.csv b.uff").code, 0);
  std::string text = content_of(path("b.uff"));
  text.resize(text.find("    -1\n", 10));
  const std::string head = text.substr(text.find('\n', 8) + 1);
  std::string uneven = "    -1\n    58\n" + head.substr(0, head.find("         4"));
  uneven += "         4         5         0  0.00000E+00  0.00000E+00  0.00000E+00\n";
  for (const char* axis : {"17", "12", " 0", " 0"}) {
    uneven += fmt::format("        {}    0    0    0 NONE                 NONE\n", axis);
  }
  for (const char* t : {"0.00000", "1.00000", "2.30000", "3.00000", "4.00000"}) {
    uneven += fmt::format("  {}E+00  1.000000000000E+00\n", t);
  }
  write("c.uff", uneven + "    -1\n");
  const Outcome refused = modcal("convert c.uff c.mat");
  EXPECT_EQ(refused.code, 3);
  EXPECT_THAT(refused.err, HasSubstr("sampling is not uniform"));
  EXPECT_THAT(refused.err, HasSubstr("resample the record, or state --sample-rate"));
}

}  // namespace
}  // namespace modcal::convert_test
