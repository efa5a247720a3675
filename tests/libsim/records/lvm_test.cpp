// LabVIEW measurement files as LabVIEW writes them.
#include <gmock/gmock.h>

#include "libsim/records/formats.hpp"
#include "tests/folder_test.hpp"
#include "tests/refusal.hpp"

namespace modcal::lvm_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::string_view kHead =
    "LabVIEW Measurement\t\nWriter_Version\t2\nReader_Version\t2\nSeparator\tTab\n"
    "Decimal_Separator\t.\nMulti_Headings\tYes\nX_Columns\tOne\nTime_Pref\tAbsolute\n"
    "Operator\tsomebody\nDate\t2016/08/23\nTime\t10:45:47.0352557312499836422\n"
    "***End_of_Header***\t\n\t\n";

// One segment of two channels that begins at an instant.
std::string segment(std::string_view time, std::string_view rows) {
  return fmt::format(
      "Channels\t2\t\t\nSamples\t3\t3\t\nDate\t2016/08/23\t2016/08/23\t\nTime\t{0}\t{0}\t\n"
      "Y_Unit_Label\tN\tg\t\nX_Dimension\tTime\tTime\t\nX0\t0.0000000000000000E+0\t0.0E+0\t\n"
      "Delta_X\t0.001000\t0.001000\t\n***End_of_Header***\t\t\t\nX_Value\tHammer\tAcc\tComment\n{1}"
      "\n",
      time, rows);
}
constexpr std::string_view kRows = "0.000000\t1.5\t-2\n0.001000\t2.5\t-3\n0.002000\t3.5\t-4\n";

struct Lvm : FolderTest {
  Recording read(std::string_view content, const ReadOptions& options = {}) const {
    return read_record(write("a.lvm", content), "auto", options);
  }
  std::string refusal(std::string_view content) const {
    return refusal_of([&] { read(content); });
  }
};

TEST_F(Lvm, ReadsChannelsUnitsKindsAndRate) {
  const Recording found = read(std::string(kHead) + segment("10:45:47", kRows));
  EXPECT_EQ(found.sample_rate, 1000.0);
  ASSERT_EQ(found.channels.size(), 2u);
  EXPECT_EQ(found.channels[0].name, "Hammer");
  EXPECT_EQ(found.channels[0].unit, "N");
  EXPECT_EQ(found.channels[0].kind, "force");
  EXPECT_THAT(found.channels[0].samples, ElementsAre(1.5, 2.5, 3.5));
  EXPECT_EQ(found.channels[1].unit, "g");
  EXPECT_EQ(found.channels[1].kind, "acceleration");
}

TEST_F(Lvm, SegmentsWithoutAGapAreOneRecord) {
  const std::string file = std::string(kHead) + segment("10:45:47.500", kRows) +
                           segment("10:45:47.503", "0\t4.5\t-5\n0.001\t5.5\t-6\n0.002\t6.5\t-7\n");
  const Recording found = read(file);
  ASSERT_EQ(found.channels.size(), 2u);
  EXPECT_THAT(found.channels[0].samples, ElementsAre(1.5, 2.5, 3.5, 4.5, 5.5, 6.5));
  EXPECT_EQ(found.sample_rate, 1000.0);
}

TEST_F(Lvm, SegmentsWithAGapAreChannelsOfTheirOwn) {
  const std::string file =
      std::string(kHead) + segment("10:45:47.500", kRows) + segment("10:45:48", kRows);
  const Recording first = read(file);
  EXPECT_EQ(first.channels.size(), 2u);
  EXPECT_THAT(first.warnings, testing::Contains(HasSubstr("\"Hammer (2)\" [N] is left out: 3 ")));
  const Recording second = read(file, {.channels = {"Hammer (2)", "Acc (2)"}});
  EXPECT_EQ(second.frames(), 3u);
  EXPECT_THAT(refusal_of([&] {
                read(file, {.channels = {"Hammer", "Acc (2)"}});
              }),
              HasSubstr("one record needs one rate, one length and one beginning"));
}

// Decimal commas, a column X a channel, comments, special headers, Latin-1, more rows than the
// first packet.
TEST_F(Lvm, ReadsWhatOlderAndOtherWritersWrite) {
  const std::string file =
      "LabVIEW Measurement\t\nWriter_Version\t0.92\nReader_Version\t1\nSeparator\tTab\n"
      "Decimal_Separator\t,\nMulti_Headings\tNo\nX_Columns\tMulti\n***End_of_Header***\t\n\t\n"
      "***Start_Special***\t\nanything\t***\n***End_Special***\t\n"
      "Channels\t2\t\t\t\nSamples\t1\t\t1\t\nDate\t2016/12/12\t\t2016/12/12\t\n"
      "Time\t09:54:07,483999\t\t09:54:07,483999\t\nY_Unit_Label\tg\t\t\xb5m\t\n"
      "Delta_X\t0,000250\t\t0,000250\t\n***End_of_Header***\t\t\t\t\t\n"
      "X_Value\tax\tX_Value\tay\tComment\n0,000000\t-0,008807\t0,000000\t-0,028189\tfirst\n"
      "0,000250\t-0,025979\t0,000250\t-0,031060\n";
  const Recording found = read(file);
  EXPECT_EQ(found.sample_rate, 4000.0);
  ASSERT_EQ(found.channels.size(), 2u);
  EXPECT_THAT(found.channels[0].samples, ElementsAre(-0.008807, -0.025979));
  EXPECT_EQ(found.channels[1].unit, "\u00b5m");
}

// Channels that were not connected are empty; separators may be commas.
TEST_F(Lvm, EmptyChannelsAreLeftOut) {
  const std::string file =
      "LabVIEW Measurement,\nSeparator,Comma\nDecimal_Separator,.\nX_Columns,No\n"
      "***End_of_Header***,\n\nChannels,2\nSamples,2,0\nX_Dimension,Time,Time\nX0,0,0\n"
      "Delta_X,2.000000E-6,2.000000E-6\n***End_of_Header***,\nX_Value,a,b,Comment\n,1,\n,2,\n";
  const Recording found = read(file);
  ASSERT_EQ(found.channels.size(), 1u);
  EXPECT_EQ(found.sample_rate, 500000.0);
  EXPECT_THAT(found.channels[0].samples, ElementsAre(1.0, 2.0));
  EXPECT_THAT(found.warnings, ElementsAre(HasSubstr("channel without samples")));
}

TEST_F(Lvm, ChannelsWithGapsAreNoRecords) {
  const std::string file =
      "LabVIEW Measurement,\nSeparator,Comma\nX_Columns,No\n***End_of_Header***,\n\nChannels,2\n"
      "Samples,2,2\nDelta_X,0.1,0.1\n***End_of_Header***,\nX_Value,a,b,Comment\n,1,1,\n,2,2\n,3,\n"
      ",4,4\n";
  EXPECT_THAT(refusal_of([&] { read(file, {.channels = {"b"}}); }),
              HasSubstr("\"b\" is no record in time but a record with gaps"));
  EXPECT_THAT(read(file).channels.at(0).samples, ElementsAre(1.0, 2.0, 3.0, 4.0));
}

TEST_F(Lvm, TellsWhereAFileIsWrong) {
  const std::string head(kHead);
  EXPECT_THAT(refusal("t,f\n0,1\n"), HasSubstr("a.lvm:1: a LabVIEW measurement file begins with"));
  EXPECT_THAT(refusal(head), HasSubstr("no segment stands behind the file's header"));
  EXPECT_THAT(refusal(head + segment("1:0:0", "0\t1\t2\n0.001\tx\t3\n")),
              HasSubstr("a.lvm:25: field 2: \"x\""));
  EXPECT_THAT(refusal(head + segment("1:0:0", "0\t1\t2\n0.001\t1\t3\n")),
              HasSubstr("3 samples of Hammer are announced in line 14, 2 are there"));
  EXPECT_THAT(refusal(head + segment("1:0:0", "0\t1\t2\n0.001\t1\n0.002\t1\t1\n")),
              HasSubstr("a.lvm:25: 2 fields stand for 3 columns"));
  // An instant is missing in the column X.
  EXPECT_THAT(
      refusal(head + segment("1:0:0", "0\t1\t2\n0.001000\t1\t1\n0.002000\t1\t2\n0.005000\t1\t1\n")),
      HasSubstr("a gap of 0.003 s"));
}

// One channel without a column X.
std::string with_step(std::string_view step, std::string_view more = "") {
  return fmt::format(
      "LabVIEW Measurement\t\nX_Columns\tNo\n***End_of_Header***\t\n\t\n{}Channels\t1\nSamples\t2\n"
      "X0\t-0.5\nDelta_X\t{}\n***End_of_Header***\t\nX_Value\ta\tComment\n\t1\t\n\t2\t\n",
      more, step);
}

TEST_F(Lvm, AStepTellsNoMoreThanItsDigits) {
  EXPECT_DOUBLE_EQ(read(with_step("0.003000")).sample_rate, 1.0 / 0.003);
  EXPECT_EQ(read(with_step("1.9531250E-5")).sample_rate, 51200.0);
  for (const auto& [step, rate] : {std::pair("0.001000", 1000.0), {"0.000050", 20000.0}}) {
    EXPECT_EQ(read(with_step(step)).sample_rate, rate);
    EXPECT_THAT(read(with_step(step)).warnings, testing::IsEmpty()) << step;
  }
  for (const char* const step : {"0.003", "0.000023", "0.000700"}) {
    EXPECT_THAT(refusal(with_step(step)), HasSubstr("too coarsely to tell the sample rate"))
        << step;
    EXPECT_EQ(read(with_step(step), {.sample_rate = 7.0}).sample_rate, 7.0);
  }
  const Recording doubted = read(with_step("0.000020"));
  EXPECT_EQ(doubted.sample_rate, 50000.0);
  EXPECT_THAT(doubted.warnings, ElementsAre(HasSubstr("from 48780.5 to 51282.1 Hz")));
}

// Whatever the last digit is: 204800, 64000, 1024 and 12500 Hz are printed so.
TEST_F(Lvm, AStepThatMayBeThatOfAnotherUsualRateIsDoubted) {
  for (const auto& [step, rate] : {std::pair("0.000005", 200000.0),
                                   {"0.000016", 62500.0},
                                   {"0.001", 1000.0},
                                   {"0.000080", 12500.0}}) {
    const Recording found = read(with_step(step));
    EXPECT_EQ(found.sample_rate, rate);
    EXPECT_THAT(found.warnings, ElementsAre(HasSubstr("state sample_rate where it is another one")))
        << step;
  }
}

TEST_F(Lvm, ARateThatTheStepLeavesOpenCanBeStated) {
  const Recording found = read(with_step("0.000020"), {.sample_rate = 51200.0});
  EXPECT_EQ(found.sample_rate, 51200.0);
  EXPECT_THAT(found.warnings, testing::IsEmpty());
  EXPECT_THAT(read(with_step("0.000020"), {.sample_rate = 44100.0}).contradictions,
              ElementsAre(HasSubstr("the file says 50000 Hz, not the stated 44100 Hz")));
}

TEST_F(Lvm, WhatModcalWroteHasItsRateAndItsBeginning) {
  const double rate = 1.0 / 0.003;
  record_format("a.lvm", "auto")
      .write(path("a.lvm"), std::vector<Signal>{{"a", "N", rate, {1.0, 2.0}}}, {"a test", -0.25});
  const Recording found = read_record(path("a.lvm"), "auto");
  EXPECT_EQ(found.sample_rate, rate);
  EXPECT_EQ(found.start, -0.25);
  EXPECT_THAT(content_of(path("a.lvm")), HasSubstr("Delta_X\t3.0000000000000001E-03\t\n"));
  // As it wrote before.
  const std::string notes = fmt::format("Notes\tsample_rate: {}\n", rate);
  EXPECT_EQ(read(with_step("0.003", notes)).sample_rate, rate);
  EXPECT_EQ(read(with_step("0.001", notes)).sample_rate, 1000.0);
}

// To its last digit, although the date has ten before the point.
TEST_F(Lvm, BeginsAtItsX0) {
  std::string file = std::string(kHead) + segment("10:45:47", kRows);
  file.replace(file.find("X0\t0.0000000000000000E+0\t0.0E+0"), 32, "X0\t-0.01\t-0.01");
  EXPECT_EQ(read(file).start, -0.01);
}

TEST_F(Lvm, TheColumnXTellsTheRateOfACoarseStep) {
  std::string rows;
  for (int i = 0; i < 1000; ++i) rows += fmt::format("{:.6f}\t1\t2\n", i / 51200.0);
  std::string file = std::string(kHead) + segment("10:45:47", rows);
  for (std::size_t at = 0; (at = file.find("0.001000\t", at)) != std::string::npos; ++at) {
    if (file.compare(at - 1, 1, "\t") == 0) file.replace(at, 8, "0.000020");
  }
  EXPECT_EQ(read(file).sample_rate, 51200.0);
}

TEST_F(Lvm, AChannelOfMoreSamplesThanItsShareIsLeftOut) {
  std::string file = std::string(kHead) + segment("10:45:47", kRows);
  file.replace(file.find("Samples\t3\t3"), 11, "Samples\t1\t3");
  const Recording found = read(file);
  EXPECT_EQ(found.channels.size(), 1u);
  EXPECT_THAT(found.warnings,
              ElementsAre(HasSubstr("3 samples, of which the line Samples announces "
                                    "1")));
}

TEST_F(Lvm, HeadersAloneEstimateTheLength) {
  std::string rows;
  for (int i = 0; i < 3000; ++i) rows += fmt::format("{:.6f}\t1.500000\t-2.000000\n", 1e-3 * i);
  const Recording found =
      read(std::string(kHead) + segment("10:45:47", rows), {.headers_only = true});
  // Rows of equal length but for the digits of the seconds; the blank line at the end.
  EXPECT_NEAR(static_cast<double>(found.frames()), 3000.0, 3.0);
  EXPECT_THAT(found.warnings, ElementsAre(HasSubstr("estimated by the size of the file")));
}

}  // namespace
}  // namespace modcal::lvm_test
