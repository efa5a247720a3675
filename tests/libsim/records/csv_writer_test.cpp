#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <bit>
#include <cmath>
#include <csignal>
#include <limits>
#include <sstream>

#include "libsim/base/random.hpp"
#include "libsim/records/record_file.hpp"
#include "tests/folder_test.hpp"
#include "tests/refusal.hpp"

namespace modcal::csv_writer_test {
namespace {

using testing::HasSubstr;

class CsvWriter : public FolderTest {};

Signal noise(const std::string& quantity, const std::string& unit, double rate, std::size_t size) {
  Signal signal{quantity, unit, rate, std::vector<double>(size)};
  fill_standard_normal(StreamKey(1).with(quantity), signal.samples);
  return signal;
}

std::string content(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

TEST_F(CsvWriter, RoundTripKeepsEveryBit) {
  // A rate without a short decimal form, names that need quotes, numbers of all magnitudes.
  std::vector<Signal> signals{noise("R1", "N", 48000.0 / 7, 4000),
                              noise("left; \"2\"", "m/s", 48000.0 / 7, 4000)};
  for (std::size_t i = 0; i < 4000; ++i) {
    signals[1].samples[i] *= std::pow(10.0, static_cast<double>(i % 600) - 300.0);
  }
  signals[0].samples[0] = -0.0;
  signals[0].samples[1] = std::numeric_limits<double>::denorm_min();
  signals[0].samples[2] = -std::numeric_limits<double>::max();
  for (const bool time_column : {true, false}) {
    write_csv(path("a.csv"), signals,
              {.time_column = time_column, .provenance = {"seed: 1\nmade"}});
    const Recording record = read_csv(path("a.csv"));
    EXPECT_EQ(record.sample_rate, signals[0].sample_rate);
    ASSERT_EQ(record.channels.size(), 2u);
    for (std::size_t c = 0; c < 2; ++c) {
      EXPECT_EQ(record.channels[c].name, signals[c].quantity);
      EXPECT_EQ(record.channels[c].unit, signals[c].unit);
      ASSERT_EQ(record.channels[c].samples.size(), 4000u);
      for (std::size_t i = 0; i < 4000; ++i) {
        ASSERT_EQ(std::bit_cast<std::uint64_t>(record.channels[c].samples[i]),
                  std::bit_cast<std::uint64_t>(signals[c].samples[i]));
      }
    }
  }
}

TEST_F(CsvWriter, TimeColumnAloneGivesTheRateBack) {
  // 120 000 rows: several blocks of output.
  const std::vector<Signal> signals{noise("R1", "N", 51200.0, 120000)};
  write_csv(path("a.csv"), signals);
  std::string text = content(path("a.csv"));
  const std::size_t comment = text.find('#');
  text.erase(comment, text.find('\n', comment) + 1 - comment);
  const Recording record = read_csv(write("b.csv", text));
  EXPECT_EQ(record.sample_rate, 51200.0);
  EXPECT_EQ(record.rate_source, "column t");
  EXPECT_EQ(record.channels[0].samples, signals[0].samples);
}

// What is written is read again: a name of the time column's, units of time, headings with marks.
TEST_F(CsvWriter, NoHeadingIsTakenForAnotherOne) {
  const auto refusal = [this](const Signal& signal) {
    return refusal_of([&] { write_csv(path("a.csv"), std::vector{signal}); });
  };
  const std::vector<double> samples = {1.0, 2.0};
  const std::vector<Signal> named{{"t", "N", 4.0, samples}, {"%", "", 4.0, samples}};
  write_csv(path("a.csv"), named);
  const Recording record = read_csv(path("a.csv"));
  EXPECT_EQ(record.channels.at(0).name, "t");
  EXPECT_EQ(record.channels.at(0).unit, "N");
  EXPECT_EQ(record.channels.at(1).name, "%");
  EXPECT_THAT(refusal({"delay", "ms", 4.0, samples}),
              HasSubstr("a column \"delay [ms]\" would be read as instants"));
  EXPECT_THAT(refusal({"Time", "", 4.0, samples}), HasSubstr("would be read as instants"));
  EXPECT_THAT(refusal({"F/mN", "", 4.0, samples}), HasSubstr("cannot be told from its heading"));
}

TEST_F(CsvWriter, WritesHeaderUnitsAndProvenance) {
  const std::vector<Signal> signals{{"R1", "N", 4.0, {0.1, 1e-300}}};
  write_csv(path("a.csv"), signals, {.time_column = true, .provenance = {"made: here"}});
  EXPECT_EQ(content(path("a.csv")),
            "t [s],R1 [N]\n# sample_rate: 4 Hz\n# made: here\n0,0.1\n0.25,1e-300\n");
}

TEST_F(CsvWriter, RefusesWhatCannotBeOneRecord) {
  const Signal good{"R1", "N", 4.0, {1.0, 2.0}};
  const auto message = [&](std::vector<Signal> signals) {
    return refusal_of([&] { write_csv(path("a.csv"), signals); });
  };
  EXPECT_THAT(message({}), HasSubstr("there is no signal to write"));
  EXPECT_THAT(message({{"R1", "N", 0.0, {1.0}}}), HasSubstr("a sample rate of 0 Hz"));
  EXPECT_THAT(message({{"R1", "N", 4.0, {}}}), HasSubstr("signal R1 has no samples to write"));
  EXPECT_THAT(message({{"", "N", 4.0, {1.0}}}), HasSubstr("signal 1 has no name"));
  EXPECT_THAT(message({good, {"R2", "N", 4.0, {1.0}}}),
              HasSubstr("R1 has 2 samples at 4 Hz, R2 has 1 at 4 Hz: signals of one file need one "
                        "rate and one length; write them to separate files"));
  EXPECT_THAT(message({good, good}), HasSubstr("two signals are named R1"));
  EXPECT_THAT(message({{"R1", "N", 4.0, {1.0, NAN}}}),
              HasSubstr("sample 1 of R1 is nan; only numbers are written"));
  EXPECT_THAT(message({{"R1 [x]", "", 4.0, {1.0}}}), HasSubstr("cannot be told from its heading"));
  EXPECT_THAT(refusal_of([&] { write_csv(path("no/a.csv"), std::vector{good}); }),
              HasSubstr("cannot be written: No such file or directory"));
  EXPECT_FALSE(std::filesystem::exists(path("a.csv")));
}

TEST_F(CsvWriter, LeavesAnExistingFileAloneWhenItFails) {
  write("a.csv", "kept");
  // As on a full disk.
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
  const rlimit nothing{0, limit.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &nothing), 0);
  const std::string reason = refusal_of([&] {
    write_csv(path("a.csv"), std::vector{Signal{"R1", "N", 4.0, {1.0}}});
  });
  setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, before);
  EXPECT_THAT(reason, HasSubstr("a.csv: writing failed: File too large"));
  EXPECT_EQ(content(path("a.csv")), "kept");
}

}  // namespace
}  // namespace modcal::csv_writer_test
