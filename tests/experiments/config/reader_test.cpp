#include "experiments/config/reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/experiments/config/example_options.hpp"
#include "tests/experiments/config/mistakes_of.hpp"

namespace modcal::reader_test {
namespace {

using testing::ExampleOptions;
using testing::mistakes;
using testing::mistakes_after_string;

TEST(YamlReader, FillsOptions) {
  ExampleOptions options;
  options.stop = 0.0;
  EXPECT_EQ(mistakes(R"(string:
  length: 330 mm
  linear_density: 3.1 g/m
  fundamental: 196 Hz
  modes: 10
  damping: {type: polynomial, coefficients: [1e-3, 0.1 %]}
decay: 4 s/m
stop: end
windows: [0.7 s, 780 ms]
seeds: [3]
remove_mean: false
note: 2010
content: spectra
quantities: [f_c]
band: {low: 1 kHz}
bands:
  - {low: 2}
  - low: 3
    high: 4
)",
                     {}, &options),
            "");
  EXPECT_EQ(options.string.length, 0.33);
  EXPECT_EQ(options.string.linear_density, 3.1e-3);
  EXPECT_EQ(options.string.modes, 10);
  const std::vector<double> omega = {1.0, 2.0};
  EXPECT_EQ(options.string.damping.make()->ratios(omega)[1], 1e-3 + 2 * 1e-3);
  EXPECT_EQ(options.decay, 4.0);
  EXPECT_TRUE(std::isnan(options.stop));
  EXPECT_EQ(options.windows, (std::vector{0.7, 0.78}));
  EXPECT_EQ(options.seeds, (std::vector<std::int64_t>{3}));
  EXPECT_FALSE(options.remove_mean);
  EXPECT_EQ(options.note, "2010");
  EXPECT_EQ(options.content, "spectra");
  EXPECT_EQ(options.quantities, (std::vector<std::string>{"f_c"}));
  EXPECT_TRUE(options.has_band);
  EXPECT_EQ(options.band.low, 1000.0);
  ASSERT_EQ(options.bands.size(), 2u);
  EXPECT_EQ(options.bands[1].high, 4.0);
}

TEST(YamlReader, TakesAPluginByItsNameAlone) {
  EXPECT_EQ(mistakes_after_string("optional_damping: polynomial\n"), "");
}

TEST(YamlReader, NamesThePluginsWhereTheTypeIsMissing) {
  EXPECT_EQ(mistakes_after_string("optional_damping: {ratio: 0}\n"),
            fmt::format("a.yaml:3:19: error: optional_damping needs a type: one of {}\n"
                        "    optional_damping: {{ratio: 0}}\n"
                        "                      ^\n",
                        fmt::join(Choice<DampingLaw>().names(), ", ")));
}

TEST(YamlReader, ReportsAllMistakesOfAFileAtOnceSortedByPlace) {
  EXPECT_EQ(
      mistakes("note: \xC3\xA9 # \xC2\xB5\n"
               "string: {lenght: 1 m, linear_density: 1 kg, fundamental: -196 Hz, modes: 010,\n"
               "  damping: {type: constant, ratio: 2}}\n"
               "windows: []\n"
               "stop: .inf\n"
               "note: again\n"),
      "a.yaml:2:9: error: missing key \"length\": vibrating length L [m]\n"
      "    string: {lenght: 1 m, linear_density: 1 kg, fundamental: -196 Hz, modes: 010,\n"
      "            ^\n"
      "a.yaml:2:10: error: unknown key \"lenght\"; did you mean \"length\"?\n"
      "    string: {lenght: 1 m, linear_density: 1 kg, fundamental: -196 Hz, modes: 010,\n"
      "             ^\n"
      "a.yaml:2:39: error: linear_density: \"1 kg\" has the unit kg, which cannot be converted to "
      "kg/m: a number in kg/m, such as 3.1 g/m, is needed\n"
      "    string: {lenght: 1 m, linear_density: 1 kg, fundamental: -196 Hz, modes: 010,\n"
      "                                          ^\n"
      "a.yaml:2:58: error: fundamental is -196 Hz: it must be > 0 Hz\n"
      "    string: {lenght: 1 m, linear_density: 1 kg, fundamental: -196 Hz, modes: 010,\n"
      "                                                             ^\n"
      "a.yaml:2:74: error: modes: \"010\" looks octal: write it without the leading 0\n"
      "    string: {lenght: 1 m, linear_density: 1 kg, fundamental: -196 Hz, modes: 010,\n"
      "                                                                             ^\n"
      "a.yaml:3:36: error: ratio is 2: it must be in [0, 1)\n"
      "      damping: {type: constant, ratio: 2}}\n"
      "                                       ^\n"
      "a.yaml:4:10: error: windows is an empty list\n"
      "    windows: []\n"
      "             ^\n"
      "a.yaml:5:7: error: stop: \".inf\" is not finite: a number in s, such as 1 us, is needed (or "
      "end)\n"
      "    stop: .inf\n"
      "          ^\n"
      "a.yaml:6:1: error: duplicate key \"note\": it stands in line 1 already\n"
      "    note: again\n"
      "    ^\n");
}

TEST(YamlReader, CountsColumnsInCharacters) {
  EXPECT_EQ(mistakes("\xEF\xBB\xBF" + std::string(testing::kString) +
                     "band: {\"\xC2\xB5\xC2\xB5\": 1, low: x}\r\n"),
            "a.yaml:3:8: error: unknown key \"\xC2\xB5\xC2\xB5\"; known: low, high\n"
            "    band: {\"\xC2\xB5\xC2\xB5\": 1, low: x}\n"
            "           ^\n"
            "a.yaml:3:22: error: low: \"x\" is not a number: a number in Hz, such as 51.2 kHz, is "
            "needed\n"
            "    band: {\"\xC2\xB5\xC2\xB5\": 1, low: x}\n"
            "                         ^\n");
}

TEST(Assignments, ReplaceAddAndDescend) {
  ExampleOptions options;
  EXPECT_EQ(mistakes(std::string(testing::kString) +
                         "optional_damping: constant\nbands: [{low: 1}, {low: 2, high: 3}]\n",
                     {"string.length=650 mm", "optional_damping.ratio=2e-3", "band.low=3 Hz",
                      "windows=[1 s]", "bands.1.high=9", "note=a=b"},
                     &options),
            "");
  EXPECT_EQ(options.string.length, 0.65);
  const std::vector<double> omega = {1.0};
  EXPECT_EQ(options.optional_damping.make()->ratios(omega)[0], 2e-3);
  EXPECT_EQ(options.band.low, 3.0);
  EXPECT_EQ(options.windows, std::vector{1.0});
  EXPECT_EQ(options.bands[1].high, 9.0);
  EXPECT_EQ(options.note, "a=b");
}

TEST(Assignments, AreNamedInMistakesAfterThoseOfTheFile) {
  EXPECT_EQ(mistakes(std::string(testing::kString) + "share: 2\nbands: [{low: 1}]\n",
                     {"decay=5 m", "strng.length=1", "bands.2.low=1", "decay=", "decay", "a..b=1",
                      "decay=[1", "decay=5", "decay=5", "decay=x"}),
            "a.yaml:3:8: error: share is 2: it must be in [0, 1]\n"
            "    share: 2\n"
            "           ^\n"
            "command line, --set 2: error: unknown key \"strng\"; did you mean \"string\"?\n"
            "    strng.length=1\n"
            "    ^\n"
            "command line, --set 3: error: the list has no item \"2\": it has 1, which count from "
            "0\n"
            "    bands.2.low=1\n"
            "    ^\n"
            "command line, --set 4: error: \"decay=\" has no value: write it behind the =, or "
            "leave --set "
            "out\n"
            "    decay=\n"
            "    ^\n"
            "command line, --set 5: error: \"decay\" is not key.path=value\n"
            "    decay\n"
            "    ^\n"
            "command line, --set 6: error: \"a..b\" is no path of an option: write its keys from "
            "the top with dots between, as in scene.bow.position\n"
            "    a..b=1\n"
            "    ^\n"
            "command line, --set 7: error: this \"[\" is not closed: add \"]\" behind its last "
            "item\n"
            "    decay=[1\n"
            "          ^\n"
            "command line, --set 10: error: decay: \"x\" is not a number: a number in s/m, such as "
            "5 s/m, is needed\n"
            "    decay=x\n"
            "          ^\n");
}

}  // namespace
}  // namespace modcal::reader_test
