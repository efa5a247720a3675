#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "libsim/records/record_file.hpp"
#include "tests/libsim/records/csv_text.hpp"

namespace modcal::csv_reader_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class CsvReader : public CsvText {};

constexpr std::string_view kPlain = "t [s],R1 [N],R2 (mN)\n0,1,-4\n0.5,2.5,5e-1\n1,+3,6\n";

void expect_plain(const Recording& record) {
  ASSERT_EQ(record.channels.size(), 2u);
  EXPECT_EQ(record.channels[0].name, "R1");
  EXPECT_EQ(record.channels[0].unit, "N");
  EXPECT_EQ(record.channels[1].name, "R2");
  EXPECT_EQ(record.channels[1].unit, "mN");
  EXPECT_THAT(record.channels[0].samples, ElementsAre(1.0, 2.5, 3.0));
  EXPECT_THAT(record.channels[1].samples, ElementsAre(-4.0, 0.5, 6.0));
  EXPECT_EQ(record.sample_rate, 2.0);
}

std::string replaced(std::string_view text, std::string_view from, std::string_view to) {
  std::string result;
  while (true) {
    const std::size_t at = text.find(from);
    result += text.substr(0, at);
    if (at == std::string_view::npos) return result;
    result += to;
    text.remove_prefix(at + from.size());
  }
}

TEST_F(CsvReader, ReadsNamedColumnsWithUnits) { expect_plain(read(kPlain)); }

// As many loggers write them; a heading's own unit is the more particular one.
TEST_F(CsvReader, ReadsUnitsBelowTheNames) {
  expect_plain(read("t,R1,R2\ns,N,mN\n0,1,-4\n0.5,2.5,5e-1\n1,+3,6\n"));
  expect_plain(read("t;R1;R2 (mN)\n[ms];(N);\n0;1;-4\n500;2.5;5e-1\n1000;+3;6\n"));
  const Recording numbers = read("t,R1,R2\n0,1,2\n1,3,4\n");
  EXPECT_EQ(numbers.channels[0].unit, "");
  EXPECT_THAT(numbers.channels[0].samples, ElementsAre(1.0, 3.0));
  // Neither a word nor what is no number is a unit.
  EXPECT_THAT(error("t,R1,R2\nseconds?,N,N\n0,1,2\n1,3,4\n"), HasSubstr("r.csv:2:1: sample 0"));
  EXPECT_THAT(error("t,R1,R2\n0,nan,inf\n1,3,4\n"), HasSubstr("\"nan\" is no usable sample"));
  EXPECT_EQ(
      error("t,R1,R2\ns,N\n0,1,2\n1,3,4\n"),
      "r.csv:2:1: the row has 2 fields, the header names 3 columns; give every row one number "
      "per column");
}

TEST_F(CsvReader, DetectsSeparators) {
  expect_plain(read(replaced(kPlain, ",", ";")));
  expect_plain(read(replaced(kPlain, ",", "\t")));
  expect_plain(read(replaced(kPlain, ",", " , ")));
}

TEST_F(CsvReader, TakesEveryLineEndAndAMissingLastOne) {
  expect_plain(read(replaced(kPlain, "\n", "\r\n")));
  expect_plain(read(replaced(kPlain, "\n", "\r")));
  expect_plain(read(kPlain.substr(0, kPlain.size() - 1)));
  expect_plain(read(replaced(kPlain, "\n", "\r\n").substr(0, kPlain.size() + 2)));
}

TEST_F(CsvReader, SkipsByteOrderMarkCommentsAndBlankLines) {
  expect_plain(read("\xEF\xBB\xBF" + std::string(kPlain)));
  expect_plain(read("# made by hand\n\n  # another, with \"quotes\n" +
                    replaced(kPlain, "1,+3,6", "\n# in the middle\n   \n1,+3,6\n\n")));
}

TEST_F(CsvReader, UnderstandsQuotedHeadings) {
  expect_plain(read(replaced(kPlain, "R1 [N]", "\"R1 [N]\"")));
  const Recording record = read("t;\"left; \"\"bridge\"\"\nside [N]\"\n0;1\n0.5;2\n");
  ASSERT_EQ(record.channels.size(), 1u);
  EXPECT_EQ(record.channels[0].name, "left; \"bridge\"\nside");
  EXPECT_EQ(record.channels[0].unit, "N");
  EXPECT_EQ(record.sample_rate, 2.0);
}

TEST_F(CsvReader, ReadsExtremeNumbersExactly) {
  const Recording record = read(
      "# sample_rate: 1 Hz\nx\n1.7976931348623157e308\n4.9406564584124654e-324\n-0.0\n"
      "2.2250738585072011e-308\n0.1\n");
  const auto& x = record.channels[0].samples;
  ASSERT_EQ(x.size(), 5u);
  EXPECT_EQ(x[0], std::numeric_limits<double>::max());
  EXPECT_EQ(x[1], std::numeric_limits<double>::denorm_min());
  EXPECT_TRUE(x[2] == 0.0 && std::signbit(x[2]));
  EXPECT_EQ(x[3], 2.2250738585072011e-308);
  EXPECT_EQ(x[4], 0.1);
}

TEST_F(CsvReader, ChoosesColumnsByNameOrNumberInTheOrderAsked) {
  const std::string_view text = "t,a,note,b\n0,1,hello,3\n1,4,,6\n";
  const Recording record = read(text, {.channels = {"4", "a"}});
  ASSERT_EQ(record.channels.size(), 2u);
  EXPECT_THAT(record.channels[0].samples, ElementsAre(3.0, 6.0));
  EXPECT_THAT(record.channels[1].samples, ElementsAre(1.0, 4.0));
}

TEST_F(CsvReader, ReportsFieldsThatAreNoNumbers) {
  EXPECT_EQ(
      error("t,R1 [N]\n0,1\n1, abc\n2,3\n"),
      "r.csv:3:4: sample 1 of R1: \"abc\" is not a number; write digits with a decimal point, "
      "such as -0.25 or 1e-3");
  EXPECT_EQ(error("t,R1\n0,\n1,2\n"),
            "r.csv:2:3: sample 0 of R1: the field is empty; every row needs a number in every "
            "column");
  EXPECT_EQ(error("t,R1\n0,1\n1,nan\n2,-inf\n"),
            "r.csv:3:3: sample 1 of R1: \"nan\" is no usable sample; repair it, or keep only the "
            "rows before or behind it\n"
            "r.csv:4:3: sample 2 of R1: \"-inf\" is no usable sample; repair it, or keep only the "
            "rows before or behind it");
  EXPECT_EQ(error("t,R1\n0,1e400\n1,1e-400\n"),
            "r.csv:2:3: sample 0 of R1: \"1e400\" is outside the range of double precision "
            "(4.9e-324 … 1.8e308)\n"
            "r.csv:3:3: sample 1 of R1: \"1e-400\" is outside the range of double precision "
            "(4.9e-324 … 1.8e308)");
  EXPECT_THAT(error("t,R1\n0,0x10\n1,2\n"), HasSubstr("\"0x10\" is not a number"));
  EXPECT_THAT(error("# sample_rate: 1 Hz\na b\n1 2\n"),
              HasSubstr("\"1 2\" is not a number; separate columns by commas, semicolons or tabs"));
}

// As German and French programs export.
TEST_F(CsvReader, ReadsDecimalCommasWhereTheyDoNotSeparate) {
  for (const char separator : {';', '\t'}) {
    std::string text = "t [s];R1 [N]\n0;1\n0,001;-0,25\n0,002;+1,5e-3\n0,003;,125\n";
    std::ranges::replace(text, ';', separator);
    const Recording found = read(text);
    EXPECT_EQ(found.sample_rate, 1000.0);
    ASSERT_EQ(found.channels.size(), 1u);
    EXPECT_THAT(found.channels[0].samples, testing::ElementsAre(1.0, -0.25, 1.5e-3, 0.125));
  }
  EXPECT_EQ(error("t,R1\n0,0,1,5\n"),
            "r.csv:2:1: the row has 4 fields, the header names 2 columns; if these are decimal "
            "commas, write decimal points");
}

TEST_F(CsvReader, KnowsCommasThatCannotMarkThousands) {
  for (const char* number : {"10132,512", "1,234E-03", "0,123", "1,25", "-,125"}) {
    const Recording found =
        read("# sample_rate: 1 Hz\nR1;R2\n" + std::string(number) + ";5\n1;6\n");
    std::string with_point(number);
    std::ranges::replace(with_point, ',', '.');
    EXPECT_EQ(found.channels[0].samples[0], std::stod(with_point)) << number;
  }
  // A row behind a mark of comments is one whatever marks its decimals.
  EXPECT_THAT(error("# sample_rate: 1 Hz\nR1;R2\n0,25;1,5\n#DIV/0!;1,7\n0,27;1,8\n"),
              HasSubstr("begins a row of samples"));
}

TEST_F(CsvReader, RefusesCommasThatMayMarkThousands) {
  EXPECT_EQ(error("# sample_rate: 1 Hz\nR1;R2\n1,234;5\n2,345;6\n"),
            "r.csv: the comma of 1,234 may mark decimals or thousands; write decimal points");
  EXPECT_THAT(
      error("# sample_rate: 1 Hz\nR1;R2\n1,234;5.5\n2,345;6\n"),
      HasSubstr("the comma of 1,234 would mark decimals, for which other numbers have points"));
  EXPECT_THAT(error("# sample_rate: 1 Hz\nR1;R2\n1,234.5;5\n2,345;6\n"),
              HasSubstr("\"1,234.5\" is not a number"));
  EXPECT_THAT(error("0,5;1,5\n1,5;2,5\n"), HasSubstr("the first row holds numbers"));
}

TEST_F(CsvReader, ReportsRaggedRows) {
  EXPECT_EQ(
      error("t,R1,R2\n0,1,2\n1,2\n2,3,4\n"),
      "r.csv:3:1: the row has 2 fields, the header names 3 columns; give every row one number "
      "per column");
}

TEST_F(CsvReader, CountsProblemsBeyondTheFirstTen) {
  std::string text = "# sample_rate: 1 Hz\nR1\n";
  for (int i = 0; i < 25; ++i) text += "x\n";
  const std::string message = error(text);
  EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 10);
  EXPECT_THAT(message, testing::EndsWith("\n… and 15 more of this file"));
}

TEST_F(CsvReader, SurveyKeepsGoing) {
  const Recording record =
      read("t,R1,R2\n0,1,2\n1,x\n2,nan,3\n", {.channels = {}, .sample_rate = 1.0, .survey = true});
  EXPECT_EQ(record.problem_count, 3u);
  EXPECT_EQ(record.frames(), 3u);
  EXPECT_TRUE(std::isnan(record.channels[0].samples[1]));
  EXPECT_TRUE(std::isnan(record.channels[1].samples[1]));
  EXPECT_EQ(record.channels[1].samples[2], 3.0);
}

// Octave's and Matlab's.
TEST_F(CsvReader, PercentBeginsAComment) {
  const Recording record = read("% sample_rate: 100 Hz\n% by hand\nR1 [N]\n1\n2\n");
  EXPECT_EQ(record.sample_rate, 100.0);
  EXPECT_EQ(record.frames(), 2u);
}

TEST_F(CsvReader, ReportsBadHeaders) {
  EXPECT_EQ(error("t,R1,R1 [N]\n0,1,2\n"),
            "r.csv:1:6: columns 2 and 3 are both named \"R1\"; give them different names");
  EXPECT_EQ(error("t,,R1\n0,1,2\n"), "r.csv:1:3: column 2 has no name; name every column");
  EXPECT_EQ(error("0,1\n1,2\n"),
            "r.csv:1:1: the first row holds numbers; put a row of names before it, such as t "
            "[s],R1 [N] (with numpy.savetxt: comments=\"\")");
  EXPECT_EQ(error("t\n0\n1\n"), "r.csv:1:1: there is a time column but no channel");
}

TEST_F(CsvReader, ReportsMissingColumns) {
  const std::string_view text = "t,Reaction1,R2\n0,1,2\n1,2,3\n";
  EXPECT_EQ(error(text, {.channels = {"reaktion1"}}),
            "r.csv:1: there is no channel \"reaktion1\", did you mean \"Reaction1\"?; the file has "
            "3 channels: t, Reaction1, R2");
  EXPECT_EQ(error(text, {.channels = {"4"}}),
            "r.csv:1: there is no channel \"4\", did you mean \"t\"?; the file has 3 channels: t, "
            "Reaction1, R2");
  EXPECT_EQ(error(text, {.channels = {"R2", "3"}}),
            "r.csv:1: channel \"R2\" is asked for twice; give every role a channel of its own");
  EXPECT_EQ(error(text, {.channels = {"t"}}),
            "r.csv:1:1: column \"t\" is the time column, not a channel");
}

TEST_F(CsvReader, ReportsFilesThatHoldNoRecord) {
  EXPECT_EQ(error(""), "r.csv: the file is empty; a record needs a header and samples");
  EXPECT_EQ(error("# only\n# comments\n"),
            "r.csv: no header; the first row must name the columns, such as t [s],R1 [N]");
  EXPECT_EQ(error("t,R1\n"), "r.csv: there is a header but no row of samples");
  EXPECT_THAT(error(std::string_view("R\0i\0f\0f\0", 8)), HasSubstr("this is not 8-bit text"));
  EXPECT_THAT(error("\xFF\xFEt"), HasSubstr("save it as UTF-8 text"));
  EXPECT_THAT(refusal_of([&] { read_csv(path("missing.csv")); }),
              HasSubstr("missing.csv: cannot be opened: No such file or directory"));
  EXPECT_THAT(refusal_of([&] { read_csv(folder()); }), HasSubstr("this is a folder, not a file"));
}

TEST_F(CsvReader, ReportsMisplacedQuotes) {
  EXPECT_EQ(error("t,R1\n0,\"1\n1,2\n"),
            "r.csv:2: the quote opened on this line is never closed; add the missing \"");
  EXPECT_EQ(error("t,R1\n0,1\"2\n"),
            "r.csv:2: a quote stands inside a field; a field with quotes is written \"a "
            "\"\"quoted\"\" word\"");
}

TEST_F(CsvReader, TakesTimeAndForceWithTheirUnitsBehindAMark) {
  for (const char* heading :
       {"time/ms", "time / ms", "t (ms)", "time_ms", "Time ms", "T.ms", "t/ms"}) {
    write("r.csv", std::string(heading) + ",R1/mN,t_max,a/b\n0,1,2,1\n0.5,2,3,1\n1,3,4,1\n");
    const Recording record = read_csv(path("r.csv"));
    EXPECT_DOUBLE_EQ(record.sample_rate, 2000.0) << heading;
    ASSERT_EQ(record.channels.size(), 3u) << heading;
    EXPECT_EQ(record.channels[0].name, "R1");
    EXPECT_EQ(record.channels[0].unit, "mN");
    EXPECT_EQ(record.channels[1].name, "t_max");
    EXPECT_EQ(record.channels[2].name, "a/b");
  }
}

TEST_F(CsvReader, ReadsTheSeparatorThatExcelStates) {
  const Recording record = read("sep=;\nt [s];a [N];b\n0;0,5;1\n0,001;1,5;2\n");
  EXPECT_EQ(record.sample_rate, 1000.0);
  EXPECT_THAT(record.channels.at(0).samples, ElementsAre(0.5, 1.5));
}

// As pandas writes the numbers of rows.
TEST_F(CsvReader, LeavesOutAColumnThatNumbersTheRows) {
  const Recording record = read("# fs = 10\n,a [N],b\n0,1,2\n1,3,4\n2,5,6\n");
  ASSERT_EQ(record.channels.size(), 2u);
  EXPECT_EQ(record.channels[0].name, "a");
  EXPECT_THAT(record.warnings, ElementsAre(HasSubstr("r.csv:2:1: column 1 has no name and numbers "
                                                     "the rows: it is left out")));
  EXPECT_THAT(read(",t,a\n0.0,0.0,1\n0.5,0.5,2\n").channels.at(0).name, "a");
  EXPECT_THAT(error("# fs = 10\n,a\n0,1\n2,3\n"),
              HasSubstr("r.csv:2:1: column 1 has no name; name every column"));
}

}  // namespace
}  // namespace modcal::csv_reader_test
