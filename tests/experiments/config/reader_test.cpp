#include "experiments/config/reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/experiments/config/example_options.hpp"

namespace modcal {
namespace {

using testing::ExampleOptions;

/// What a user sees of a text and of arguments with mistakes.
std::string mistakes(const std::string& yaml, const std::vector<std::string>& arguments = {},
                     ExampleOptions* options = nullptr) {
  YamlDocument document = parse_yaml(yaml, "a.yaml");
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    apply_assignment(document, arguments[i], i + 1);
  }
  std::vector<Mistake> found = document.mistakes;
  ExampleOptions unused;
  ExampleOptions& target = options != nullptr ? *options : unused;
  if (document.root.kind == YamlNode::Kind::kMap) {
    read_options(
        document.root, [&](OptionVisitor& visitor) { target.visit(visitor); }, found);
  }
  return format_mistakes(document, found);
}

/// The same for a text that follows two right lines.
std::string mistakes_after_string(const std::string& yaml) {
  return mistakes(std::string(testing::kString) + yaml);
}

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

struct Case {
  std::string yaml;
  std::string expected;
};

class WrongValue : public ::testing::TestWithParam<Case> {};

TEST_P(WrongValue, IsReportedWithItsPlaceAndTheRemedy) {
  EXPECT_EQ(mistakes_after_string(GetParam().yaml), GetParam().expected);
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, WrongValue,
    ::testing::Values(
        Case{"decya: 5\n",
             "a.yaml:3:1: error: unknown key \"decya\"; did you mean \"decay\"?\n"
             "    decya: 5\n"
             "    ^\n"},
        Case{"band: {low: 1, qqqqqq: 2}\n",
             "a.yaml:3:16: error: unknown key \"qqqqqq\"; known: low, high\n"
             "    band: {low: 1, qqqqqq: 2}\n"
             "                   ^\n"},
        Case{"decay: 4\nshare: 0\ndecay: 5\n",
             "a.yaml:5:1: error: duplicate key \"decay\": it stands in line 3 already\n"
             "    decay: 5\n"
             "    ^\n"},
        Case{"band: {high: 2}\n",
             "a.yaml:3:7: error: missing key \"low\": lower end [Hz]\n"
             "    band: {high: 2}\n"
             "          ^\n"},
        Case{"decay: 5 m/s\n",
             "a.yaml:3:8: error: decay: \"5 m/s\" has the unit m/s, which cannot be converted to "
             "s/m: a number in s/m, such as 5 s/m, is needed\n"
             "    decay: 5 m/s\n"
             "           ^\n"},
        Case{"share: 120 %\n",
             "a.yaml:3:8: error: share is 120 %: it must be in [0, 1]\n"
             "    share: 120 %\n"
             "           ^\n"},
        Case{"share: .nan\n",
             "a.yaml:3:8: error: share: \".nan\" is not finite: a number is needed\n"
             "    share: .nan\n"
             "           ^\n"},
        Case{"seeds: [1, 010]\n",
             "a.yaml:3:12: error: seeds: \"010\" looks octal: write it without the leading 0\n"
             "    seeds: [1, 010]\n"
             "               ^\n"},
        Case{"seeds: [1.5]\n",
             "a.yaml:3:9: error: seeds must be a whole number, not \"1.5\"\n"
             "    seeds: [1.5]\n"
             "            ^\n"},
        Case{"stop: never\n",
             "a.yaml:3:7: error: stop: \"never\" is not a number: a number in s, such as 1 us, is "
             "needed (or end)\n"
             "    stop: never\n"
             "          ^\n"},
        Case{"decay:\n",
             "a.yaml:4:1: error: decay: there is no value: a number in s/m, such as 5 s/m, is "
             "needed\n"},
        Case{"decay: {a: 1}\n",
             "a.yaml:3:8: error: decay must be a number in s/m, not a map\n"
             "    decay: {a: 1}\n"
             "           ^\n"},
        Case{"decay: \"5\"\n",
             "a.yaml:3:8: error: decay must be a number in s/m, not a quoted text\n"
             "    decay: \"5\"\n"
             "           ^\n"},
        Case{"remove_mean: yes\n",
             "a.yaml:3:14: error: remove_mean must be true or false, not \"yes\"\n"
             "    remove_mean: yes\n"
             "                 ^\n"},
        Case{"content: spectrum\n",
             "a.yaml:3:10: error: content: \"spectrum\" is not one of waveforms, spectra; did you "
             "mean \"spectra\"?\n"
             "    content: spectrum\n"
             "             ^\n"},
        Case{"band: 3\n",
             "a.yaml:3:7: error: band must be a map of keys and values, not a single value\n"
             "    band: 3\n"
             "          ^\n"},
        Case{"bands: [{low: 1}, 2]\n",
             "a.yaml:3:19: error: each of bands must be a map, not a single value\n"
             "    bands: [{low: 1}, 2]\n"
             "                      ^\n"},
        Case{"optional_damping: constnt\n",
             "a.yaml:3:19: error: optional_damping: unknown damping \"constnt\"; did you mean "
             "\"constant\"?\n"
             "    optional_damping: constnt\n"
             "                      ^\n"},
        Case{"---\ndecay: 1\n",
             "a.yaml:3:1: error: a second YAML document (---) begins here: keep one in a file\n"
             "    ---\n"
             "    ^\n"},
        Case{"decay: &d 5\n",
             "a.yaml:3:8: error: anchors (&d) are not supported: write the value out\n"
             "    decay: &d 5\n"
             "           ^\n"},
        Case{"decay: *d\n",
             "a.yaml:3:8: error: aliases (*name) are not supported: write the value out\n"
             "    decay: *d\n"
             "           ^\n"},
        Case{"<<: {decay: 1}\n",
             "a.yaml:3:1: error: merge keys (<<) are not supported: write the values out\n"
             "    <<: {decay: 1}\n"
             "    ^\n"},
        Case{"decay: !!float 5\n",
             "a.yaml:3:8: error: the tag tag:yaml.org,2002:float is not supported: leave it out\n"
             "    decay: !!float 5\n"
             "           ^\n"},
        Case{"note: \"open\n",
             "a.yaml:3:7: error: the quote \" is not closed: end the text with \"\n"
             "    note: \"open\n"
             "          ^\n"},
        Case{"note: 'it''s open\n",
             "a.yaml:3:7: error: the quote ' is not closed: end the text with '\n"
             "    note: 'it''s open\n"
             "          ^\n"}));

class WrongText : public ::testing::TestWithParam<Case> {};

TEST_P(WrongText, IsReportedWithItsPlaceAndTheRemedy) {
  EXPECT_EQ(mistakes(GetParam().yaml), GetParam().expected);
}

INSTANTIATE_TEST_SUITE_P(
    Kinds, WrongText,
    ::testing::Values(
        Case{"", "a.yaml:1:1: error: the file is empty: an experiment starts with kind:\n"},
        Case{"# nothing\n",
             "a.yaml:1:1: error: the file is empty: an experiment starts with kind:\n"
             "    # nothing\n"
             "    ^\n"},
        Case{"- 1\n",
             "a.yaml:1:1: error: the file must be a map of keys and values, kind: first\n"
             "    - 1\n"
             "    ^\n"},
        Case{"string:\n\tlength: 1\n",
             "a.yaml:2:1: error: a tab in the indentation: use blanks\n"
             "    \tlength: 1\n"
             "    ^\n"},
        Case{"note: \xFF\n",
             "a.yaml:1:7: error: byte 0xff is not UTF-8 text: save the file as UTF-8\n"
             "    note: \xFF\n"
             "          ^\n"},
        Case{"windows: [1, 2\nseeds: 3\n",
             "a.yaml:1:10: error: this \"[\" is not closed: add \"]\" behind its last item\n"
             "    windows: [1, 2\n"
             "             ^\n"},
        Case{"band: {low: 1\n",
             "a.yaml:1:7: error: this \"{\" is not closed: add \"}\" behind its last entry\n"
             "    band: {low: 1\n"
             "          ^\n"},
        Case{"decay: 1\n  share: 2\n",
             "a.yaml:2:8: error: a \":\" cannot stand here: begin the keys of one map in one "
             "column, "
             "and put a text with \": \" in it into quotes\n"
             "      share: 2\n"
             "           ^\n"},
        Case{"windows: [1]\n",
             "a.yaml:1:1: error: missing key \"string\": the string; it needs length, "
             "linear_density, fundamental\n"
             "    windows: [1]\n"
             "    ^\n"}));

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
            "command line, --set 4: error: \"decay=\" is not key.path=value\n"
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
}  // namespace modcal
