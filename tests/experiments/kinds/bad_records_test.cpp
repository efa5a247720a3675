// Every way in which a record goes bad: a right answer or one clear refusal. The records are those
// of benchmarks/truth, the list is that of benchmarks/truth/bad_records.py (hum:
// foreign_record_test).
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "benchmarks/truth/truth.hpp"
#include "experiments/kinds/invert/invert.hpp"
#include "experiments/loader.hpp"
#include "tests/experiments/kinds/spoiled_record.hpp"
#include "tests/folder_test.hpp"
#include "tests/refusal.hpp"

namespace modcal::bad_records_test {
namespace {

constexpr double kFundamental = 294.0, kInharmonicity = 1.1e-4, kContact = 0.041;

/// Refused with a text, contradicted, or accepted and right where it is empty.
struct Row {
  const char* name;
  const char* refusal;
  Spoil spoil;
};

const char kSigns[] =
    "record.csv: channels R1 and R2, the reactions at x = 0 and x = L, would be those of the "
    "string stated if one of them had the other sign";
const char kEnds[] =
    "if the ends were exchanged: state record.left: {channel: R2}, record.right: "
    "{channel: R1}, or bow.position 288 mm";
const char kBoth[] = "if the ends were exchanged and one of them had the other sign";
const char kCopies[] = "are one signal, x = L reading";
const char kGap[] = "contradict each other near 0.1";
const char kOther[] = "are not those of one string with f0 within 3 % of";
const char kEdge[] = "stands at the edge of that; check f0 and the sample rate";
const char kRate[] = "record.sample_rate is stated and the file contradicts it";

// Run, and failed by χ² or the priors.
const char kContradicted[] = "contradicted";

// Samples and lengths.
std::vector<Row> rows_of_samples() {
  return {
      {"good", "", scaled(1.0, 1.0)},
      {"nan", "record.csv:7682:6: sample 7680 of R1: \"nan\"", cell("nan")},
      {"inf", "\"inf\" is no usable sample", cell("inf")},
      {"text", "\"overload\" is not a number", cell("overload")},
      {"empty", "the field is empty", cell(" ")},
      {"1e300", "record.csv:7682: channel R1, sample 7680 (0.15 s): 1e+300", cell("1e300")},
      {"1e300 all", "outside the range of double precision", scaled(1e300, 1e300)},
      {"spike of 10", "stands alone", spike(10.0)},
      {"spike of 1e6", "stands alone", spike(1e6)},
      {"zero left", "samples are 0: the channel is silent", scaled(0.0, 1.0)},
      {"zero both", "record.csv:2: channel R1, sample 0 (0 s): all", scaled(0.0, 0.0)},
      {"constant right", "the channel is silent", both(scaled(1.0, 0.0), raised(0.0, 0.3))},
      {"four samples", "record.csv: 4 samples at 51200 Hz are 7.81e-05 s", kept(0.0, 4.5 / 15360)},
      {"fifty samples", "less than two periods of the string", kept(0.0, 50.5 / 15360)},
  };
}

// Channels that are clipped, silent or cut off.
std::vector<Row> rows_of_channels() {
  return {
      {"clipped at 95 %", "", clipped(0.95, true, true)},
      {"clipped at 80 %", "the peaks are clipped", clipped(0.8, true, true)},
      {"clipped left", "channel R1", clipped(0.5, true, false)},
      {"clipped right", "channel R2", clipped(0.5, false, true)},
      {"saturated to a quarter", "that at x = 0 reads 75 % too little at its peaks, that at x = L",
       saturated(4.0, true, true)},
      {"saturated to three", "saturate: that at x = 0 reads 24 %", saturated(1.0, true, true)},
      {"saturated left", "reads 67 % too little at its peaks. A string",
       saturated(3.0, true, false)},
      {"gap of zeros, 1 ms", "samples in a row are 0", filled(51, false)},
      {"gap of zeros, 100 ms", "samples in a row are 0", filled(5120, false)},
      {"gap held, 0.1 ms", "samples in a row are", filled(5, true)},
      {"gap held, 10 ms", "samples in a row are", filled(512, true)},
      {"cut off left", "record.csv:3074: channel R1, sample 3072 (0.06 s): all 12288 samples",
       silent(0.2, 1.0, true, false)},
      {"cut off both", "the channel was cut off", silent(0.2, 1.0, true, true)},
      {"cut off late", "channel R2", silent(0.97, 1.0, false, true, 0.3)},
      {"late left", "channel R1 is 0 up to 0.03 s, while channel R2",
       silent(0.0, 0.1, true, false)},
      {"late right", "record.start", silent(0.0, 0.5, false, true, 0.3)},
      {"late both", "the beginning was filled", silent(0.0, 0.3, true, true)},
  };
}

// Samples lost, and rates.
std::vector<Row> rows_of_clocks() {
  return {
      {"gap in time, 1 sample", "record.csv:7682: sample 7680: a gap of", lost(1, "jumps")},
      {"gap in time, 100 ms", "a gap of", lost(5120, "jumps")},
      {"gap in time, rate stated", kRate, both(lost(51, "jumps"), stated_rate(51200))},
      {"lost, 1 sample", kGap, lost(1, "goes on")},
      {"lost, 1 ms", kGap, lost(51, "goes on")},
      {"lost, 10 ms", kGap, lost(512, "rate")},
      {"rate stated 1 % off", kRate, stated_rate(50688)},
      {"rate stated 44.1 for 48", kRate, stated_rate(47040)},
      {"comment 1e-4 off", "the comment says 51205 Hz, column t says 51200 Hz",
       commented_rate(51205)},
      {"comment 1 % off", "correct one of them", commented_rate(50688)},
      {"clock 48 for 44.1", kEdge, file_clock(48.0 / 44.1)},
  };
}

// What both ends are to each other, and whole records.
std::vector<Row> rows_of_ends() {
  return {
      {"copies", kCopies, copied(1.0)},
      {"copies, 0.7", "x = L reading 0.7 times x = 0", copied(0.7)},
      {"copies, -1", kCopies, copied(-1.0)},
      {"noise alone", "channel R2, the reaction at x = L, holds nothing but noise",
       noise_for_right()},
      {"offset", "", raised(300.0, -200.0)},
      {"begun in mid-stroke", "", kept(0.3, 1.0)},
      {"ended in mid-stroke", "", kept(0.0, 0.7)},
      {"sign left", kSigns, scaled(-1.0, 1.0)},
      {"sign right", kSigns, scaled(1.0, -1.0)},
      {"sign both", "", scaled(-1.0, -1.0)},
      {"exchanged", kEnds, exchanged()},
      {"exchanged and turned", kBoth, both(exchanged(), scaled(-1.0, 1.0))},
      {"late by 1 ms", kOther, late(51)},
      {"8 bit", "", rounded(8)},
      {"backwards", kContradicted, reversed()},
      {"low-passed at 16 kHz", "is empty above 1.6", low_passed(16000.0)},
      {"gain of 2", "read 1.99", scaled(1.0, 2.0)},
  };
}

class BadRecords : public FolderTest {
 protected:
  static const Written& good() {
    static const Written written = written_at(kContact);
    return written;
  }

  static Written written_at(double contact) {
    truth::TruthRecord record =
        truth::simulate({.fundamental = kFundamental, .inharmonicity = kInharmonicity},
                        {.position = contact}, {.duration = 0.3, .start = 0.0});
    add_noise(record, 0.01, 7);
    Written result;
    for (std::size_t j = 0; j < record.r1.size(); ++j) {
      result.t.push_back(static_cast<double>(j) / record.rate);
    }
    for (std::size_t i = 0; i < 50; ++i) {
      result.frequencies.push_back(fmt::format("{:.9g} Hz", record.modes[i].omega / (2.0 * M_PI)));
      result.ratios.push_back(fmt::format("{:.9g}", record.modes[i].decay / record.modes[i].omega));
    }
    result.r1 = record.r1;
    result.r2 = record.r2;
    return result;
  }

  // The refusal, or the result.
  std::string run(const Written& record, const std::string& kind, StudyResult& result,
                  const std::string& estimator = "joint", double contact = 0.042) {
    write("record.csv", record.text());
    const bool calibrates = kind == "calibrate";
    const LoadedExperiment loaded = load_experiment(parse_yaml(
        fmt::format(
            "kind: {}\nrecord: {{file: record.csv, left: {{channel: R1}}, right: {{channel: "
            "R2}}{}}}\nstring: {{length: 0.33 m, linear_density: 1e-3 kg/m, fundamental: {} Hz, "
            "inharmonicity: {}, modes: 40, damping: {{type: table, frequencies: [{}], ratios: "
            "[{}]}}}}\nbow: {{position: {} m}}\n{}",
            kind, record.keys, calibrates ? 1.01 * kFundamental : kFundamental, kInharmonicity,
            fmt::join(record.frequencies, ", "), fmt::join(record.ratios, ", "), contact,
            calibrates ? "calibration: {parameters: {frequencies: none}}\n"
                       : fmt::format("inversion: {{estimator: {}}}\n", estimator)),
        path("experiment.yaml").string()));
    EXPECT_EQ(format_mistakes(loaded.document, loaded.mistakes), "");
    return refusal_of([&] {
      result = loaded.experiment->run({.work = work_, .folder = folder(), .command = "test"});
    });
  }

  static void expect_right(const StudyResult& result) {
    EXPECT_EQ(result.status, report::Status::kOk) << result.summary;
    const auto file = std::find_if(result.files.begin(), result.files.end(),
                                   [](const auto& one) { return one.first == "calibration.json"; });
    ASSERT_NE(file, result.files.end());
    const std::map<std::string, double> truth = {
        {"f0", kFundamental}, {"B", kInharmonicity}, {"x_c", kContact}};
    std::size_t found = 0;
    const auto document = nlohmann::json::parse(file->second);
    for (const auto& parameter : document["parameters"]) {
      const auto known = truth.find(parameter["name"].get<std::string>());
      if (known == truth.end()) continue;
      ++found;
      const double z =
          (parameter["final"].get<double>() - known->second) / parameter["sd"].get<double>();
      EXPECT_LT(std::abs(z), 4.0) << known->first;
    }
    EXPECT_EQ(found, truth.size());
  }

  void expect(const std::vector<Row>& rows) {
    for (const Row& row : rows) {
      SCOPED_TRACE(row.name);
      Written record = good();
      row.spoil(record);
      StudyResult result;
      const std::string said = run(record, "calibrate", result);
      if (row.refusal[0] == '\0') {
        EXPECT_EQ(said, "accepted");
        if (said == "accepted") expect_right(result);
        continue;
      }
      if (row.refusal == kContradicted) {
        EXPECT_EQ(said, "accepted");
        EXPECT_EQ(result.status, report::Status::kFailed);
        EXPECT_THAT(result.answer, testing::HasSubstr("the rows stand in reverse"));
        continue;
      }
      EXPECT_THAT(said, testing::HasSubstr(row.refusal));
      // An inversion takes no worse records, whatever inverts.
      for (const char* estimator : {"joint", "one_sided", "model_based", "auto"}) {
        EXPECT_NE(run(record, "invert", result, estimator), "accepted") << estimator;
      }
    }
  }

  SharedWork work_;
};

TEST_F(BadRecords, GiveARightAnswerOrOneClearRefusalOfSamples) { expect(rows_of_samples()); }
TEST_F(BadRecords, GiveARightAnswerOrOneClearRefusalOfChannels) { expect(rows_of_channels()); }
TEST_F(BadRecords, GiveARightAnswerOrOneClearRefusalOfClocks) { expect(rows_of_clocks()); }
TEST_F(BadRecords, GiveARightAnswerOrOneClearRefusalOfEnds) { expect(rows_of_ends()); }

// Both reactions are one signal there, of any string.
TEST_F(BadRecords, OfAStringBowedInItsMiddleAreInvertedAndNotCalibrated) {
  const Written middle = written_at(0.165);
  StudyResult result;
  EXPECT_THAT(run(middle, "calibrate", result, "", 0.1655),
              testing::HasSubstr("with the contact in its middle are whatever f0"));
  EXPECT_EQ(run(middle, "invert", result, "joint", 0.165), "accepted");
  EXPECT_EQ(result.status, report::Status::kOk);
  EXPECT_THAT(result.warnings, testing::Contains(testing::HasSubstr("taken as stated")));
  // Copies of a stroke elsewhere are still refused as such.
  Written copies = good();
  copied(1.0)(copies);
  EXPECT_THAT(run(copies, "invert", result), testing::HasSubstr("are one signal"));
}

TEST_F(BadRecords, AreNotInvertedWithAnotherTuning) {
  StudyResult result;
  Written record = good();
  EXPECT_EQ(run(record, "invert", result), "accepted");
  file_clock(1.01)(record);
  EXPECT_THAT(run(record, "invert", result),
              testing::HasSubstr("the reactions are those of a string with f0 near 291"));
}

TEST_F(BadRecords, MaySayHowFastTheirClockRan) {
  Written record = good();
  record.keys = ", sample_rate: 51205 Hz";
  StudyResult result;
  EXPECT_EQ(run(record, "invert", result), "accepted");
  EXPECT_THAT(result.summary,
              testing::HasSubstr("the file says 51200 Hz, the stated 51205 Hz is used"));
}

}  // namespace
}  // namespace modcal::bad_records_test
