#include "libsim/records/universal/universal_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <numbers>
#include <random>

#include "libsim/base/random.hpp"
#include "libsim/base/units.hpp"
#include "libsim/records/formats.hpp"
#include "tests/folder_test.hpp"
#include "tests/refusal.hpp"

namespace modcal::universal_file_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class Universal : public FolderTest {
 protected:
  /// What reading headers and all values says of a file of this content.
  std::string said_of(std::string_view content) const {
    std::filesystem::remove(path("a.uff"));
    const auto file = write("a.uff", content);
    return refusal_of([&] {
      for (const UniversalFunction& function : read_universal_headers(file).functions) {
        read_universal_values(file, function);
      }
      read_record(file, "auto", {.survey = true});
    });
  }
};

struct Kind {
  int data_type;
  bool even, binary, big_endian;
};

template <typename Number>
void put(std::string& text, Number value, bool big_endian) {
  std::array<char, sizeof value> bytes{};
  std::memcpy(bytes.data(), &value, sizeof value);
  if (big_endian) std::reverse(bytes.begin(), bytes.end());
  text.append(bytes.data(), bytes.size());
}

// What stands between the header and the end, with lines that are not full.
std::string values_text(const Kind& kind, const UniversalValues& values) {
  const bool is_double = kind.data_type == 4 || kind.data_type == 6;
  std::string text;
  std::size_t on_line = 0;
  const auto add = [&](double value, bool wide) {
    if (kind.binary) {
      if (is_double) return put(text, value, kind.big_endian);
      return put(text, static_cast<float>(value), kind.big_endian);
    }
    text += wide ? fmt::format("{:20.12E}", value) : fmt::format("{:13.5E}", value);
    if (++on_line % 4 == 0) text += "\n";
  };
  for (std::size_t i = 0; i < values.values.size(); ++i) {
    if (!kind.even) add(values.abscissa[i], false);
    add(values.values[i].real(), is_double);
    if (kind.data_type >= 5) add(values.values[i].imag(), is_double);
  }
  if (!kind.binary && on_line % 4 != 0) text += "\n";
  return text;
}

std::string file_of(const Kind& kind, const UniversalValues& values,
                    std::string_view name =
                        "Kr\xe4"
                        "ft") {
  const std::string data = values_text(kind, values);
  std::string text = "    -1\n   151\nmodel\nNONE\n    -1\n";
  text += "    -1\n    58";
  if (kind.binary) {
    text += fmt::format("b{:6}{:6}{:12}{:12}{:6}{:6}{:12}{:12}", kind.big_endian ? 2 : 1, 2, 11,
                        data.size(), 0, 0, 0, 0);
  }
  text += fmt::format("\n{}\nNONE\nNONE\nNONE\nNONE\n", name);
  text += "    1         0    0         0 NONE               7   3 NONE               0   0\n";
  text += fmt::format("{:10}{:10}{:10}{:13.5E}{:13.5E}{:13.5E}\n", kind.data_type,
                      values.values.size(), kind.even ? 1 : 0, 0.0, kind.even ? 1e-3 : 0.0, 0.0);
  text += "        17    0    0    0 T\xe9mps                s                   \n";
  text += "        12    0    0    0 Acceleration         g                   \n";
  text += "         0    0    0    0 NONE                 NONE                \n";
  text += "         0    0    0    0 NONE                 NONE                \n";
  return text + data + (kind.binary ? "\n" : "") + "    -1\n";
}

// Numbers that floats and few digits hold.
UniversalValues numbers(std::size_t count, bool even) {
  UniversalValues result;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = static_cast<double>(i);
    result.values.emplace_back(0.25 * x - 1.0, 0.5 - x);
    if (!even) result.abscissa.push_back(x / 1024.0 * 1024.0);
  }
  return result;
}

std::vector<Kind> all_kinds() {
  std::vector<Kind> kinds;
  for (const int type : {2, 4, 5, 6}) {
    for (const bool even : {true, false}) {
      kinds.push_back({type, even, false, false});
      kinds.push_back({type, even, true, false});
      kinds.push_back({type, even, true, true});
    }
  }
  return kinds;
}

TEST_F(Universal, ReadsEveryKindOfValuesToTheLastDigit) {
  for (const Kind& kind : all_kinds()) {
    const UniversalValues written = numbers(23, kind.even);
    const auto file = write("a.uff", file_of(kind, written));
    const UniversalFile headers = read_universal_headers(file);
    ASSERT_EQ(headers.functions.size(), 1u);
    EXPECT_THAT(headers.other_datasets, ElementsAre(151));
    const UniversalFunction& function = headers.functions[0];
    EXPECT_EQ(function.name, "Kräft");
    EXPECT_EQ(function.places.response_node, 7);
    EXPECT_EQ(function.ordinate.unit, "g");
    EXPECT_EQ(function.abscissa.unit, "s");
    const UniversalValues read = read_universal_values(file, function);
    EXPECT_EQ(read.abscissa, written.abscissa);
    ASSERT_EQ(read.values.size(), written.values.size());
    for (std::size_t i = 0; i < read.values.size(); ++i) {
      EXPECT_EQ(read.values[i].real(), written.values[i].real());
      EXPECT_EQ(read.values[i].imag(), kind.data_type >= 5 ? written.values[i].imag() : 0.0);
    }
  }
}

TEST_F(Universal, FunctionsOfTimeAreChannels) {
  const Kind kind{2, true, false, false};
  const std::string one = file_of(kind, numbers(23, true), "A"),
                    two = file_of(kind, numbers(23, true), "B"),
                    frf = file_of({5, true, false, false}, numbers(9, true), "C");
  const auto file = write("a.unv", one + two + frf);
  const Recording record = read_record(file, "auto");
  ASSERT_EQ(record.channels.size(), 2u);
  EXPECT_EQ(record.sample_rate, 1000.0);
  EXPECT_EQ(record.format, "universal file, 3 functions");
  EXPECT_EQ(record.channels[1].name, "B");
  EXPECT_EQ(record.channels[1].kind, "acceleration");
  EXPECT_DOUBLE_EQ(to_si(1.0, record.channels[1].unit, "m/s2"), 9.80665);
  ASSERT_EQ(record.warnings.size(), 1u);
  EXPECT_THAT(record.warnings[0], HasSubstr("\"C\""));
  EXPECT_THAT(refusal_of([&] { read_record(file, "auto", {.channels = {"C"}}); }),
              HasSubstr("is no record in time but a complex"));
  const Recording headers = read_record(file, "auto", {.headers_only = true});
  EXPECT_TRUE(headers.channels[0].samples.empty());
  EXPECT_EQ(headers.frames(), 23u);
}

TEST_F(Universal, ChannelsThatBeginApartAreNoRecord) {
  const std::string one = file_of({2, true, false, false}, numbers(23, true), "A");
  const std::size_t at = one.find("  0.00000E+00  1.00000E-03");
  const auto with = [&](std::string_view t) { return std::string(one).replace(at, t.size(), t); };
  const auto late = write("late.unv", one + with("  2.00000E-02  1.00000E-03"));
  EXPECT_THAT(
      refusal_of([&] {
        read_record(late, "auto", {.channels = {"A", "A (2)"}});
      }),
      HasSubstr("has 23 samples at 1000 Hz from 0.02 s on, \"A\" has 23 samples at 1000 Hz; "
                "one record needs one rate, one length and one beginning"));
  EXPECT_EQ(read_record(late, "auto").channels.size(), 1u);
  const auto near = write("near.unv", one + with("  1.00000E-05  1.00000E-03"));
  EXPECT_EQ(read_record(near, "auto").channels.size(), 2u);
  // 1/51200 = 1.953125e-5 is halfway between two texts of six digits.
  const auto tie = write("tie.unv", with("  0.00000E+00  1.95313E-05"));
  EXPECT_EQ(read_record(tie, "auto").sample_rate, 51200.0);
}

TEST_F(Universal, ReadsResponseFunctionsWithTheirUnits) {
  std::string text = file_of({6, true, false, false}, numbers(9, true), "C");
  // Over frequency from 2 Hz in steps of 1 Hz, g per lbf.
  text.replace(text.find("    1         0    0"), 5, "    4");
  text.replace(text.find("  0.00000E+00  1.00000E-03"), 26, "  2.00000E+00  1.00000E+00");
  text.replace(text.find("        17    0"), 10, "        18");
  text.replace(text.find("         0    0    0    0 NONE                 NONE"), 53,
               "        13    0    0    0 Force                lbf ");
  const auto file = write("a.uff", text + file_of({2, true, false, false}, numbers(5, true), "A"));
  const ResponseFunctions read = read_response_functions(file, "auto", {"C"});
  ASSERT_EQ(read.functions.size(), 1u);
  EXPECT_EQ(read.functions[0].unit, "g");
  EXPECT_EQ(read.functions[0].per_unit, "lbf");
  EXPECT_EQ(read.functions[0].kind, "acceleration");
  EXPECT_EQ(read.grid.bins, 11u);
  EXPECT_DOUBLE_EQ(read.grid.omega(2), 2.0 * 2.0 * std::numbers::pi);
  EXPECT_TRUE(std::isnan(read.functions[0].values[1].real()));
  EXPECT_EQ(read.functions[0].values[4], numbers(9, true).values[2]);
  EXPECT_THAT(refusal_of([&] { read_response_functions(file, "auto", {"A"}); }),
              HasSubstr("\"A\" is no response function over even lines but has 5 samples"));
  EXPECT_THAT(refusal_of([&] { read_response_functions(write("a.wav", "RIFF"), "auto", {"A"}); }),
              HasSubstr("WAV and other sound files keep no response functions"));
}

TEST_F(Universal, UnitsOfDataset164ScaleWhatHasNoLabel) {
  std::string text = file_of({2, true, false, false}, numbers(5, true));
  text.replace(text.find("g      "), 4, "NONE");
  const auto file = write("a.uff",
                          "    -1\n   164\n         5                             2\n    1.0D+03"
                          "                    1.0D+03                  1.0\n  273.15\n    -1\n" +
                              text);
  const Recording record = read_record(file, "uff");
  EXPECT_EQ(record.channels[0].unit, "m/s2");
  EXPECT_DOUBLE_EQ(record.channels[0].full_scale, 1e-3);
}

TEST_F(Universal, WhatIsWrittenIsReadToTheLastBit) {
  std::vector<Signal> signals{{"R1", "N", 1023.5 / 3.0, std::vector<double>(1000)},
                              {"plate, far end", "m/s2", 1023.5 / 3.0, std::vector<double>(1000)}};
  fill_uniform(StreamKey(5), signals[0].samples);
  fill_uniform(StreamKey(6), signals[1].samples);
  write_universal(path("a.uff"), signals, {"here"});
  const Recording record = read_record(path("a.uff"), "auto");
  ASSERT_EQ(record.channels.size(), 2u);
  EXPECT_EQ(record.sample_rate, 1023.5 / 3.0);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(record.channels[i].name, signals[i].quantity);
    EXPECT_EQ(record.channels[i].unit, signals[i].unit);
    EXPECT_EQ(record.channels[i].samples, signals[i].samples);
  }
}

TEST_F(Universal, AByteOrderMarkIsPassedOver) {
  write_universal(path("a.uff"), std::vector<Signal>{{"R1", "N", 10.0, {1.0, 2.0}}},
                  {.provenance = "here", .start = -0.5});
  const Recording record =
      read_record(write("b.uff", "\xef\xbb\xbf" + content_of(path("a.uff"))), "auto");
  EXPECT_EQ(record.channels.at(0).samples, (std::vector<double>{1.0, 2.0}));
  EXPECT_EQ(record.start, -0.5);
}

TEST_F(Universal, TruncatedFilesAreReadOrRefusedWithThePlace) {
  for (const Kind& kind : all_kinds()) {
    const std::string whole = file_of(kind, numbers(7, kind.even));
    int accepted = 0;
    for (std::size_t size = 0; size < whole.size(); ++size) {
      const std::string said = said_of(whole.substr(0, size));
      accepted += said == "accepted" ? 1 : 0;
      EXPECT_TRUE(said == "accepted" || said.starts_with(path("a.uff").string())) << said;
    }
    // The line end behind the last -1.
    EXPECT_EQ(accepted, 1);
  }
}

TEST_F(Universal, ChangedBytesAreReadOrRefused) {
  std::mt19937 random(3);
  int refused = 0;
  for (const Kind& kind : all_kinds()) {
    const std::string whole = file_of(kind, numbers(7, kind.even));
    for (int i = 0; i < 300; ++i) {
      std::string changed = whole;
      for (int k = 0; k < 3; ++k) changed[random() % whole.size()] = static_cast<char>(random());
      refused += said_of(changed) != "accepted" ? 1 : 0;
    }
  }
  EXPECT_GT(refused, 500);
}

TEST_F(Universal, AnnouncedSizesAreNotBelieved) {
  std::string text = file_of({4, true, false, false}, numbers(5, true));
  text.replace(text.find("         5         1"), 10, "9999999999");
  EXPECT_THAT(refusal_of([&] { read_record(write("a.uff", text), "auto"); }),
              HasSubstr("9999999999 values are announced"));
}

TEST_F(Universal, ReadsRealFiles) {
  const char* const data = std::getenv("MODCAL_REAL_DATA");
  if (data == nullptr) GTEST_SKIP() << "MODCAL_REAL_DATA names no folder";
  const std::filesystem::path real(data);
  const auto sample = real / "uff_Sample_UFF58b_bin.uff";
  const Recording record = read_record(sample, "auto");
  ASSERT_EQ(record.channels.size(), 1u);
  EXPECT_EQ(record.sample_rate, 65536.0);
  EXPECT_EQ(record.channels[0].unit, "Pa");
  EXPECT_EQ(record.channels[0].kind, "pressure");
  // The second reading: the 317168 bytes before the end, as they lie there.
  const std::string bytes = content_of(sample);
  const std::size_t begin = bytes.rfind("    -1") - 317168;
  ASSERT_EQ(record.frames(), 79292u);
  for (std::size_t i = 0; i < record.frames(); ++i) {
    float value = 0.0f;
    std::memcpy(&value, bytes.data() + begin + 4 * i, sizeof value);
    ASSERT_EQ(record.channels[0].samples[i], static_cast<double>(value)) << i;
  }
  const UniversalFile groups = read_universal_headers(real / "uff_groups_test.uff");
  EXPECT_THAT(groups.other_datasets, ElementsAre(2420, 2411, 2412, 2467));
  EXPECT_EQ(groups.units->code, 1);
  const UniversalFile engine = read_universal_headers(real / "uff_heat_engine_housing.uff");
  EXPECT_THAT(engine.other_datasets, ElementsAre(151, 2411, 2412, 2414));
  EXPECT_EQ(engine.units->factors[0], 1000.0);
  EXPECT_THAT(refusal_of([&] { read_record(real / "uff_groups_test.uff", "auto"); }),
              HasSubstr("no function (dataset 58) stands in it, only datasets 2420"));
}

}  // namespace
}  // namespace modcal::universal_file_test
