// Functions of frequency that are written are read again to the last bit.
#include <gmock/gmock.h>

#include <bit>
#include <cmath>
#include <numbers>

#include "libsim/records/formats.hpp"
#include "libsim/records/frequency_lines.hpp"
#include "libsim/records/universal/universal_file.hpp"
#include "tests/folder_test.hpp"
#include "tests/refusal.hpp"

namespace modcal::function_files_test {
namespace {

using testing::HasSubstr;

using Lines = std::vector<double>;

FileFunction function_at(const Lines& hertz, const std::string& name, const std::string& unit,
                         const std::string& per_unit,
                         FrequencyFunction what = FrequencyFunction::kResponse) {
  FileFunction function;
  function.name = name;
  function.unit = unit;
  function.per_unit = per_unit;
  function.what = what;
  function.hertz = hertz;
  for (std::size_t m = 0; m < hertz.size(); ++m) {
    const double x = static_cast<double>(m);
    function.values.emplace_back(1.0 / (3.0 + x), function.is_real() ? 0.0 : -1e-7 * x);
  }
  return function;
}

FileFunctions two_and_a_coherence(const Lines& hertz) {
  FileFunctions all;
  all.functions = {function_at(hertz, "head \u00e9 1", "m/s2", "N"),
                   function_at(hertz, "h2", "g", "lbf"),
                   function_at(hertz, "c1", "", "", FrequencyFunction::kCoherence)};
  return all;
}

void expect_bits(const std::vector<double>& found, const std::vector<double>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t m = 0; m < found.size(); ++m) {
    EXPECT_EQ(std::bit_cast<std::uint64_t>(found[m]), std::bit_cast<std::uint64_t>(expected[m]))
        << m << ": " << found[m] << " " << expected[m];
  }
}

void expect_same(const FileFunctions& found, const FileFunctions& expected) {
  ASSERT_EQ(found.functions.size(), expected.functions.size());
  for (std::size_t i = 0; i < found.functions.size(); ++i) {
    const FileFunction &one = found.functions[i], &other = expected.functions[i];
    EXPECT_EQ(one.name, other.name);
    EXPECT_EQ(one.unit, other.unit) << one.name;
    EXPECT_EQ(one.per_unit, other.per_unit) << one.name;
    EXPECT_EQ(one.what, other.what) << one.name;
    expect_bits(one.hertz, other.hertz);
    EXPECT_EQ(one.values, other.values) << one.name;
  }
}

class FunctionFiles : public FolderTest, public testing::WithParamInterface<std::string_view> {
 protected:
  std::filesystem::path file() const { return path("a." + std::string(GetParam())); }
  std::string format() const { return std::string(GetParam()); }
  FileFunctions read() const { return read_functions(file(), format()); }
  void write_all(FileFunctions all) const {
    EXPECT_EQ(write_functions(file(), format(), all, "a test"), all.functions.size());
    EXPECT_TRUE(all.warnings.empty());
  }
};

// Decimals, sums of a step that is no double, multiples of one that has all its digits, and none.
std::vector<Lines> all_lines() {
  Lines decimals, multiples, thirds, rounded;
  for (int m = 0; m < 40; ++m) {
    decimals.push_back(m / 10.0);
    multiples.push_back((m + 2) * 0.1);
    thirds.push_back(m * (44100.0 / 1001.0));
    rounded.push_back(std::round(m * 1e3 / 3.0) / 1e3);
  }
  return {decimals, multiples, thirds, rounded, {1.0, 2.5, 2.75, 1e3 / 3.0}, {3.0, 4.0}};
}

TEST_P(FunctionFiles, KeepEveryBitNameAndUnit) {
  for (const Lines& hertz : all_lines()) {
    const FileFunctions all = two_and_a_coherence(hertz);
    write_all(all);
    expect_same(read(), all);
    EXPECT_TRUE(read().warnings.empty());
    EXPECT_TRUE(has_functions_alone(file(), format(), 1e9));
  }
}

TEST_P(FunctionFiles, AnIdentificationReadsTheSameNumbers) {
  Lines hertz;
  for (int m = 0; m < 281; ++m) hertz.push_back((m + 3) / 10.0);
  const FileFunctions all = two_and_a_coherence(hertz);
  write_all(all);
  const ResponseFunctions read =
      read_response_functions(file(), format(), {"h2", all.functions[0].name});
  EXPECT_EQ(read.grid.spacing, 2.0 * std::numbers::pi * 0.1);
  EXPECT_EQ(read.grid.bins, 284u);
  EXPECT_EQ(read.functions[0].unit, "g");
  EXPECT_EQ(read.functions[0].per_unit, "lbf");
  EXPECT_TRUE(std::isnan(read.functions[1].values[2].real()));
  EXPECT_EQ(read.functions[1].values[3], all.functions[0].values[0]);
  EXPECT_EQ(read.functions[1].values[283], all.functions[0].values[280]);
  const ResponseFunctions told =
      read_response_functions(file(), format(), {"c1"}, FrequencyFunction::kCoherence);
  EXPECT_EQ(told.functions[0].values[283], all.functions[2].values[280]);
}

TEST_P(FunctionFiles, UnevenLinesAreNoGrid) {
  write_all(two_and_a_coherence({1.0, 2.5, 2.75}));
  EXPECT_THAT(refusal_of([&] { read_response_functions(file(), format(), {"h2"}); }),
              HasSubstr("3 lines that are not even"));
}

TEST_P(FunctionFiles, UnitsThatAreNotToldStayUntold) {
  FileFunctions all;
  all.functions = {function_at({1.0, 2.0}, "a", "", "lbf"), function_at({1.0, 2.0}, "b", "", ""),
                   function_at({1.0, 2.0}, "c", "m", "")};
  write_all(all);
  expect_same(read(), all);
}

TEST_P(FunctionFiles, WhatIsNoNumberIsRefused) {
  FileFunctions all = two_and_a_coherence({1.0, 2.0, 4.5});
  all.functions[1].values[2] = {1.0, std::numeric_limits<double>::quiet_NaN()};
  EXPECT_THAT(refusal_of([&] { write_functions(file(), format(), all, ""); }),
              HasSubstr("the value of h2 at 4.5 Hz is 1 + nani; only numbers are written"));
  for (FileFunction& function : all.functions) function.hertz[2] = 2.0;
  EXPECT_THAT(refusal_of([&] { write_functions(file(), format(), all, ""); }),
              HasSubstr("frequencies must increase"));
  EXPECT_FALSE(std::filesystem::exists(file()));
}

TEST_P(FunctionFiles, AFileCutOffAtAnyByteIsRefused) {
  const FileFunctions all = two_and_a_coherence({1.0, 2.0, 4.5});
  write_all(all);
  const std::string bytes = content_of(file());
  const std::size_t step = GetParam() == "hdf5" ? 101 : 1;
  // A universal file may end behind any of its functions, a MAT file behind any variable; a table
  // may lose its last digits.
  for (std::size_t size = 0; size < bytes.size(); size += step) {
    write(file().filename().string(), std::string_view(bytes).substr(0, size));
    FileFunctions found;
    const std::string said = refusal_of([&] { found = read(); });
    if (said != "accepted") {
      EXPECT_THAT(said, HasSubstr(file().filename().string())) << size;
    } else if (GetParam() != "csv") {
      EXPECT_TRUE(GetParam() == "uff" || GetParam() == "mat") << size << " of " << bytes.size();
      for (std::size_t i = 0; i < found.functions.size(); ++i) {
        EXPECT_EQ(found.functions[i].values, all.functions[i].values);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Every, FunctionFiles, testing::Values("uff", "mat", "npz", "hdf5", "csv"),
                         [](const auto& test) { return std::string(test.param); });

class FunctionsIn : public FolderTest {
 protected:
  std::string refusal(const std::string& name, FileFunctions all) const {
    return refusal_of([&] { write_functions(path(name), "auto", all, ""); });
  }
};

TEST_F(FunctionsIn, OtherFormatsNameThoseThatHoldThem) {
  for (const char* name : {"a.wav", "a.lvm", "a.npy"}) {
    EXPECT_THAT(refusal(name, two_and_a_coherence({1.0, 2.0})),
                HasSubstr("these formats hold them: csv, uff, mat, npz, hdf5"));
    EXPECT_FALSE(std::filesystem::exists(path(name)));
  }
}

FileFunctions powers() {
  FileFunctions all;
  all.functions = {
      function_at({0.0, 0.5, 1.0}, "p", "g2/Hz", "", FrequencyFunction::kPowerDensity),
      function_at({0.0, 0.5, 2.0}, "s", "(m/s2)2", "", FrequencyFunction::kAutoSpectrum)};
  all.functions[0].kind = "acceleration";
  all.functions[0].places = {7, 3, 1, -3};
  return all;
}

TEST_F(FunctionsIn, PowersAreHeldByUniversalFiles) {
  FileFunctions all = powers();
  all.functions.push_back(function_at({7.0, 9.0}, "h", "m", "N"));
  EXPECT_EQ(write_functions(path("a.uff"), "auto", all, ""), 3u);
  const FileFunctions read = read_functions(path("a.uff"), "auto");
  expect_same(read, all);
  EXPECT_EQ(read.functions[0].kind, "acceleration");
  EXPECT_EQ(read.functions[0].places, all.functions[0].places);
  const UniversalFile headers = read_universal_headers(path("a.uff"));
  EXPECT_EQ(headers.functions[0].type, 9);
  EXPECT_EQ(headers.functions[1].type, 2);
  EXPECT_FALSE(headers.functions[1].is_even);
  EXPECT_EQ(read_response_functions(path("a.uff"), "auto", {"p"}, FrequencyFunction::kPowerDensity)
                .functions[0]
                .values,
            all.functions[0].values);
  EXPECT_EQ(write_functions(path("a.mat"), "auto", all, ""), 1u);
  ASSERT_EQ(all.warnings.size(), 2u);
  EXPECT_THAT(all.warnings[0],
              HasSubstr("\"p\" [g2/Hz] is left out: MAT files of MATLAB and Octave hold no power "
                        "spectral density; a universal file (.uff) holds it"));
  EXPECT_THAT(refusal("b.csv", powers()), HasSubstr("columns of text hold no power spectral"));
}

TEST_F(FunctionsIn, OtherFrequenciesThanTheFirstOnesAreLeftOut) {
  FileFunctions all = two_and_a_coherence({1.0, 2.0});
  all.functions[1] = function_at({1.0, 2.0, 3.0}, "h2", "m", "N");
  EXPECT_EQ(write_functions(path("a.npz"), "auto", all, ""), 2u);
  ASSERT_EQ(all.warnings.size(), 1u);
  EXPECT_THAT(all.warnings[0], HasSubstr("\"h2\" [m/N] is left out: archives of NumPy hold "
                                         "functions of the same frequencies alone"));
}

TEST_F(FunctionsIn, NamesThatTellAnAxis) {
  FileFunctions all = two_and_a_coherence({1.0, 2.0});
  all.functions[0].name = "F";
  all.functions[1].name = "freq";
  for (const char* name : {"a.mat", "a.h5", "a.uff"}) {
    write_functions(path(name), "auto", all, "");
    expect_same(read_functions(path(name), "auto"), all);
  }
  EXPECT_THAT(refusal("a.npz", all), HasSubstr("would be taken for the frequencies; rename"));
  EXPECT_THAT(refusal("a.csv", all), HasSubstr("cannot be told from its heading"));
  const std::vector<Signal> record{{"T", "N", 100.0, {1.0, 2.0}}, {"x", "m", 100.0, {3.0, 4.0}}};
  for (const char* name : {"t.mat", "t.h5", "t.npz", "t.npy"}) {
    const std::string said =
        refusal_of([&] { record_format(name, "auto").write(path(name), record, {}); });
    if (said != "accepted") {
      EXPECT_THAT(said, HasSubstr("would be taken for the ")) << name;
      continue;
    }
    EXPECT_EQ(read_record(path(name), "auto").channels[0].name, "T") << name;
  }
}

TEST_F(FunctionsIn, EvenLinesOfUniversalFilesAreEven) {
  for (const Lines& hertz : {all_lines()[0], all_lines()[1], all_lines()[2]}) {
    FileFunctions all = two_and_a_coherence(hertz);
    write_functions(path("a.uff"), "auto", all, "");
    const UniversalFunction header = read_universal_headers(path("a.uff")).functions[0];
    EXPECT_TRUE(header.is_even);
    EXPECT_THAT(header.id_lines[4], HasSubstr("lines: ("));
    EXPECT_NEAR(header.step, hertz[1] - hertz[0], 1e-5 * header.step);
    // Somebody changed the header: what it prints counts.
    std::string text = content_of(path("a.uff"));
    const std::string step = fmt::format("{:13.5E}", header.step);
    text.replace(text.find(step), step.size(), "  7.00000E+00");
    const auto changed = read_functions(write("b.uff", text), "auto").functions[0].hertz;
    EXPECT_NEAR(changed[1] - changed[0], 7.0, 1e-12);
  }
}

// Text with an uneven abscissa, units by the factors of dataset 164 alone.
TEST_F(FunctionsIn, TextOfOtherPrograms) {
  const std::string axes =
      "        18    0    0    0 Frequency            kHz                 \n"
      "        12    0    0    0 Acceleration         NONE                \n"
      "        13    0    0    0 Force                NONE                \n"
      "         0    0    0    0 NONE                 NONE                \n";
  const auto file =
      write("a.uff",
            "    -1\n   164\n         5                             2\n    1.0D+03             "
            "       5.0D+02                  1.0\n  273.15\n    -1\n    -1\n    58\nh\nNONE\nNONE\n"
            "NONE\nNONE\n    4         0    0         0 NONE               0   0 NONE              "
            " 0   0\n         5         3         0  0.00000E+00  0.00000E+00  0.00000E+00\n" +
                axes +
                "  1.00000E-03  2.00000E+00  4.00000E+00  2.00000E-03  6.00000E+00  8.00000E+00\n"
                "  4.00000E-03  1.00000E+00  0.00000E+00\n    -1\n");
  const FileFunctions read = read_functions(file, "auto");
  ASSERT_EQ(read.functions.size(), 1u);
  EXPECT_EQ(read.functions[0].hertz, (Lines{1.0, 2.0, 4.0}));
  EXPECT_EQ(read.functions[0].unit, "m/s2");
  // mm/s2 over 1/500 N.
  EXPECT_EQ(read.functions[0].values[1], Complex(6.0, 8.0) * (1e-3 / 2e-3));
  const std::string cut = content_of(file).substr(0, content_of(file).size() - 40);
  EXPECT_THAT(refusal_of([&] { read_functions(write("cut.uff", cut), "auto"); }),
              HasSubstr("it was cut off"));
}

TEST_F(FunctionsIn, LinesBelowZeroKeepTheirDigits) {
  const FileFunctions all = two_and_a_coherence({-1234567.25, -1234567.0, -1234566.75, -1234566.5});
  FileFunctions written = all;
  write_functions(path("a.uff"), "auto", written, "");
  expect_same(read_functions(path("a.uff"), "auto"), all);
}

// Its header may say what it is of, and dataset 164 what that is in.
TEST_F(FunctionsIn, ACoherenceIsAShareWhateverItsHeaderSays) {
  const auto file =
      write("a.uff",
            "    -1\n   164\n         5                             2\n    1.0D+03             "
            "       5.0D+02                  1.0\n  273.15\n    -1\n    -1\n    58\nc\nNONE\nNONE\n"
            "NONE\nNONE\n    6         0    0         0 NONE               0   0 NONE              "
            " 0   0\n         2         4         1  1.00000E+00  1.00000E+00  0.00000E+00\n"
            "        18    0    0    0 Frequency            Hz                  \n"
            "        12    0    0    0 Acceleration         NONE                \n"
            "        13    0    0    0 Force                NONE                \n"
            "         0    0    0    0 NONE                 NONE                \n"
            "  9.00000E-01  9.00000E-01  9.00000E-01  9.00000E-01\n    -1\n");
  const FileFunctions read = read_functions(file, "auto");
  ASSERT_EQ(read.functions.size(), 1u);
  EXPECT_EQ(read.functions[0].unit, "");
  EXPECT_NEAR(read.functions[0].values[2].real(), 0.9, 1e-7);
}

TEST(EvenLinesOf, AreTheFewestDigits) {
  const auto even = even_lines(Lines{0.0, 0.1, 0.2, 0.3});
  ASSERT_TRUE(even);
  EXPECT_EQ(even->per, 10.0);
  EXPECT_EQ(even->line(3), 0.3);
  EXPECT_EQ(even->spacing(), 0.1);
  EXPECT_FALSE(even_lines(Lines{0.0, 1.0, 2.5}));
  EXPECT_FALSE(even_lines(Lines{1.0}));
  EXPECT_FALSE(even_lines(Lines{1.0, 1.0}));
  EXPECT_FALSE(even_lines(Lines{0.0, 1.0, std::numeric_limits<double>::quiet_NaN()}));
  EXPECT_EQ(printed_lines(1.0 / 3.0, 0.5).per, 1.0);
}

TEST_F(FunctionsIn, LevelsAreNotWrittenAsColumns) {
  const FileFunctions all{.functions = {function_at({0.0, 1.0}, "h", "dB", "")}, .warnings = {}};
  FileFunctions copy = all;
  EXPECT_THAT(refusal_of([&] { write_functions(path("a.csv"), "auto", copy, ""); }),
              HasSubstr("h is in \"dB\"; write magnitudes, not levels"));
}

}  // namespace
}  // namespace modcal::function_files_test
