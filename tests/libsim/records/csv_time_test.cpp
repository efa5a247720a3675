// The clock of a CSV file: comments, the user's rate, columns of instants.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/libsim/records/csv_text.hpp"

namespace modcal::csv_time_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class CsvTime : public CsvText {};

TEST_F(CsvTime, TakesTheSampleRateFromAComment) {
  EXPECT_EQ(read("# sample_rate: 51.2 kHz\nR1\n1\n").sample_rate, 51200.0);
  EXPECT_EQ(read("#Sample Rate: 100\nR1\n1\n").sample_rate, 100.0);
}

TEST_F(CsvTime, TakesTheSampleRateOfTheUserFirst) {
  const Recording record = read("# sample_rate: 10 Hz\nR1\n1\n2\n", {.sample_rate = 20.0});
  EXPECT_EQ(record.sample_rate, 20.0);
  EXPECT_THAT(record.warnings, ElementsAre(HasSubstr("the file says 10 Hz, not the stated 20 Hz")));
  EXPECT_EQ(record.contradictions, record.warnings);
  // As a calibration of the clock tells.
  const Recording close = read("# sample_rate: 51200 Hz\nR1\n1\n2\n", {.sample_rate = 51203.0});
  EXPECT_EQ(close.sample_rate, 51203.0);
  EXPECT_EQ(close.warnings.size(), 1u);
  EXPECT_THAT(close.contradictions, testing::IsEmpty());
}

TEST_F(CsvTime, ConvertsTheUnitOfTime) {
  EXPECT_EQ(read("time [ms],R1\n0,1\n0.5,2\n1.0,3\n").sample_rate, 2000.0);
}

TEST_F(CsvTime, ForgivesTheRoundingOfPrintedInstants) {
  // 51.2 kHz printed to 1 µs: instants are off by up to 0.5 µs, 2.6 % of a period.
  std::string text = "t,R1\n";
  for (int i = 0; i < 5120; ++i) text += fmt::format("{:.6f},0\n", i / 51200.0);
  const Recording fixed = read(text);
  // End instants are off by 0.5 µs each in 0.1 s: 1e-5 relative, 0.5 Hz; whole numbers are taken.
  EXPECT_NEAR(fixed.sample_rate, 51200.0, 0.52);
  EXPECT_LE(fixed.time_jitter, 1.5e-6);
  // Six significant digits: 10 µs at t > 1 s would be too coarse, below 1 s they are 1 µs.
  text = "t,R1\n";
  for (int i = 0; i < 5120; ++i) text += fmt::format("{:.6g},0\n", i / 51200.0);
  EXPECT_NEAR(read(text).sample_rate, 51200.0, 0.52);
}

// Whole numbers of hertz lie within the printed resolution of every one of these rates.
TEST_F(CsvTime, AStepThatEveryInstantIsAMultipleOfIsTheStep) {
  for (const char* const step : {"0.003", "0.006", "0.0007", "3e-5", "0.03", "0.012"}) {
    for (const int rows : {60, 1000}) {
      std::string text = "t [s],R1\n";
      for (int i = 0; i < rows; ++i) text += fmt::format("{:.6g},0\n", i * std::stod(step));
      EXPECT_DOUBLE_EQ(read(text).sample_rate, 1.0 / std::stod(step)) << step << ' ' << rows;
    }
  }
}

// First and last instant leave room for five whole numbers of hertz; those between them do not.
TEST_F(CsvTime, AllInstantsTellTheRate) {
  for (const double rate : {51200.0, 44100.0, 65536.0}) {
    std::string text = "t [s],R1\n";
    for (int i = 0; i < 1000; ++i) text += fmt::format("{:.6f},0\n", i / rate);
    EXPECT_EQ(read(text).sample_rate, rate);
  }
}

TEST_F(CsvTime, KnowsOtherWordsOfComments) {
  EXPECT_EQ(read("# fs = 1000\nR1\n1\n").sample_rate, 1000.0);
  EXPECT_EQ(read("R1\n# dt: 1 ms\n1\n").sample_rate, 1000.0);
  EXPECT_EQ(read("# sample_rate: 10 Hz\n# dt: as set before\nR1\n1\n").sample_rate, 10.0);
}

TEST_F(CsvTime, KnowsTheUnitInTheKeyOfAComment) {
  EXPECT_EQ(read("# fs [kHz] = 51.2\nR1\n1\n").sample_rate, 51200.0);
  EXPECT_EQ(read("# dt (ms): 0.5000\nR1\n1\n").sample_rate, 2000.0);
  EXPECT_THAT(error("# fs [kHz] = 51200 Hz\nR1\n1\n"), HasSubstr("the sample rate is not known"));
}

TEST_F(CsvTime, ACommentOfThePeriodTellsNoMoreThanItsDigits) {
  EXPECT_THAT(error("# dt = 0.000023\nR1\n1\n"), HasSubstr("too coarsely to tell the sample rate"));
  EXPECT_THAT(read("# dt = 0.000020\nR1\n1\n").warnings,
              testing::ElementsAre(HasSubstr("from 48780.5 to 51282.1 Hz")));
  EXPECT_EQ(read("# dt = 0.001\nt,R1\n0.0000,1\n0.0008,2\n0.0016,3\n").sample_rate, 1250.0);
}

TEST_F(CsvTime, KnowsTheUnitOfATimeInCapitals) {
  EXPECT_EQ(read("TIME_S,R1\n0.0,1\n0.5,2\n").sample_rate, 2.0);
  EXPECT_EQ(read("T [MS],R1\n0.0,1\n0.5,2\n").sample_rate, 2000.0);
}

TEST_F(CsvTime, KnowsASecondTimeByItsNumber) {
  EXPECT_THAT(error("Time (s),a,Time (s) 2,b\n0,1,0.5,1\n1,2,1.5,2\n"),
              HasSubstr("a is sampled at 0 s (Time), b at 0.5 s (Time 2)"));
}

TEST_F(CsvTime, KnowsWhenARecordBegins) {
  EXPECT_EQ(read("t [ms],R1\n-100,1\n-99,2\n").start, -0.1);
}

TEST_F(CsvTime, ReportsInstantsPrintedTooCoarsely) {
  std::string text = "t,R1\n";
  for (int i = 0; i < 100; ++i) text += fmt::format("{:.5f},0\n", i / 51200.0);
  EXPECT_EQ(error(text),
            "r.csv: column t is printed to 1e-05 s, too coarsely to tell the sample rate; print it "
            "with more digits or state sample_rate");
  EXPECT_EQ(read(text, {.sample_rate = 51200.0}).sample_rate, 51200.0);
}

TEST_F(CsvTime, ReportsGapsJitterAndReturnsInTime) {
  EXPECT_EQ(error("t,R1\n0,1\n0.1,1\n# pause\n0.4,1\n0.5,1\n0.6,1\n"),
            "r.csv:5: sample 2: a gap of 0.3 s before 0.4 s where the steps are 0.1 s; cut "
            "what is before or behind the gap out of the file");
  EXPECT_EQ(error("t,R1\n0,1\n0.10000,1\n0.21000,1\n0.3,1\n0.4,1\n"),
            "r.csv:4: sample 2: sampling is not uniform: 0.21 s is 0.01 s (0.1 sampling periods) "
            "off the uniform grid; resample the record, or state sample_rate if its time column is "
            "not to be trusted");
  EXPECT_EQ(error("t,R1\n0,1\n0.10,1\n0.20,1\n0.20,1\n0.45,1\n"),
            "r.csv:5: sample 3: time goes from 0.2 s to 0.2 s; sampling instants must increase: "
            "sort the rows of the file by time\n"
            "r.csv:6: sample 4: a gap of 0.25 s before 0.45 s where the steps are 0.1 s; cut "
            "what is before or behind the gap out of the file");
  const std::string_view gap = "t,R1\n0,1\n0.1,1\n0.4,1\n0.5,1\n0.6,1\n";
  EXPECT_EQ(read(gap, {.sample_rate = 10.0}).warnings.size(), 2u);  // the gap, and 5 / 0.6 s ≠ 10
  EXPECT_EQ(read(gap, {.sample_rate = 10.0}).contradictions.size(), 2u);
  // A time column that is not to be trusted is no contradiction.
  const std::string_view jitter = "t,R1\n0,1\n0.10000,1\n0.21000,1\n0.3,1\n0.4,1\n";
  EXPECT_EQ(read(jitter, {.sample_rate = 10.0}).warnings.size(), 1u);
  EXPECT_THAT(read(jitter, {.sample_rate = 10.0}).contradictions, testing::IsEmpty());
}

TEST_F(CsvTime, ComparesTheInstantsOfItsChannels) {
  const std::string_view same = "t1 [s],R1,t2 [ms],R2\n0,1,0,2\n0.1,3,100,4\n0.2,5,200,6\n";
  ASSERT_EQ(read(same).channels.size(), 2u);
  EXPECT_EQ(read(same).channels[1].samples[2], 6.0);
  EXPECT_EQ(read(same).sample_rate, 10.0);
  const std::string_view apart = "t1 [s],R1,t2 [s],R2\n0,1,0,2\n0.1,3,0.14,4\n0.2,5,0.24,6\n";
  EXPECT_EQ(error(apart),
            "r.csv:3: sample 1: R1 is sampled at 0.1 s (t1), R2 at 0.14 s (t2); resample both to "
            "the same instants, or delete the time column that is wrong");
  EXPECT_EQ(read(apart, {.channels = {"R1"}}).sample_rate, 10.0);
  // Nothing was recorded at the other column's instants: a clock beside the time elapsed.
  const std::string_view clock = "time [s],clock [s],R1\n0,50,1\n0.1,50.2,2\n0.2,50.4,3\n";
  EXPECT_EQ(read(clock).sample_rate, 5.0);
  // Instants behind their channels.
  const std::string_view behind = "R1,t1 [s],R2,t2 [s]\n1,0,2,0\n3,0.1,4,0.2\n5,0.2,6,0.4\n";
  EXPECT_EQ(read(behind, {.channels = {"R2"}}).sample_rate, 5.0);
  EXPECT_EQ(error(behind, {.channels = {"t2"}}),
            "r.csv:1:14: column \"t2\" is the time column, not a channel");
}

TEST_F(CsvTime, ReportsAFileThatContradictsItself) {
  EXPECT_EQ(error("# sample_rate: 20 Hz\nt,R1\n0,1\n0.1,1\n0.2,1\n"),
            "r.csv:1: the comment says 20 Hz, column t says 10 Hz; correct one of them or state "
            "sample_rate");
  // To all that is printed: 1e-4 in f0 is tens of its deviations.
  std::string text = "# sample_rate: 51205 Hz\nt,R1\n";
  for (int i = 0; i < 5120; ++i) text += fmt::format("{:.9f},0\n", i / 51200.0);
  EXPECT_THAT(error(text), HasSubstr("the comment says 51205 Hz, column t says 51200 Hz"));
  text.replace(text.find("51205"), 5, "51200");
  EXPECT_EQ(read(text).sample_rate, 51200.0);
}

TEST_F(CsvTime, ReportsAnUnknownSampleRate) {
  const std::string remedy =
      "the sample rate is not known; state sample_rate, add a comment line \"# sample_rate: 51200 "
      "Hz\", or a column t [s] with two instants or more";
  EXPECT_EQ(error("R1\n1\n2\n"), "r.csv: " + remedy);
  EXPECT_EQ(error("t,R1\n0,1\n"), "r.csv: " + remedy);
  EXPECT_EQ(read("t,R1\n0,1\n", {.sample_rate = 5.0}).frames(), 1u);
  EXPECT_EQ(error("# sample_rate: -3 Hz\nR1\n1\n"),
            "r.csv:1: \"-3 Hz\" is no sample rate; write a positive number of hertz, such as # "
            "sample_rate: 51200 Hz");
  EXPECT_THAT(error("# sample_rate: 3 kg\nR1\n1\n"), HasSubstr("\"3 kg\" is no sample rate"));
  EXPECT_EQ(error("R1\n1\n", {.sample_rate = -1.0}),
            "sample_rate = -1 Hz cannot be used: it must be > 0");
}

}  // namespace
}  // namespace modcal::csv_time_test
