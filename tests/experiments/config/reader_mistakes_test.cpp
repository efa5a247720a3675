// Wrong values and wrong texts, each reported with its place and the remedy.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "experiments/config/reader.hpp"
#include "tests/experiments/config/mistakes_of.hpp"

namespace modcal::reader_mistakes_test {
namespace {

using testing::mistakes;
using testing::mistakes_after_string;

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
             "a.yaml:3:1: error: decay: there is no value: a number in s/m, such as 5 s/m, is "
             "needed\n"
             "    decay:\n"
             "    ^\n"},
        Case{"decay: {a: 1}\n",
             "a.yaml:3:8: error: decay must be a number in s/m, not a map\n"
             "    decay: {a: 1}\n"
             "           ^\n"},
        Case{"decay: \"5\"\n",
             "a.yaml:3:8: error: decay must be a number in s/m, not a quoted text: leave out the "
             "quotes\n"
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
        // yaml-cpp takes nothing of such a comma and would begin document after document.
        Case{"# title\n, continued\n",
             "a.yaml:2:1: error: a \",\" cannot stand here: begin comments with #, and put a text "
             "with it into quotes\n"
             "    , continued\n"
             "    ^\n"},
        Case{"[1, 2],\n",
             "a.yaml:1:7: error: a \",\" cannot stand here: begin comments with #, and put a text "
             "with it into quotes\n"
             "    [1, 2],\n"
             "          ^\n"},
        Case{"", "a.yaml:1:1: error: the file is empty: an experiment starts with kind:\n"},
        Case{"# nothing\n",
             "a.yaml:1:1: error: the file is empty: an experiment starts with kind:\n"
             "    # nothing\n"
             "    ^\n"},
        // Lines of an old Macintosh.
        Case{"# title\r- 1\r",
             "a.yaml:2:1: error: the file must be a map of keys and values, kind: first\n"
             "    - 1\n"
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
        Case{"note: \xED\xA0\x80\n",
             "a.yaml:1:7: error: byte 0xed is not UTF-8 text: save the file as UTF-8\n"
             "    note: \xED\xA0\x80\n"
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

// The cells of a sweep are readers of one map, and each knows its own keys.
TEST(UnknownKey, HasEachOfTheKnownNamedOnce) {
  const YamlDocument document = parse_yaml("sigma: 1\n", "a.yaml");
  std::vector<Mistake> mistakes;
  YamlReader base(document.root, mistakes), cell(document.root, mistakes);
  for (YamlReader* reader : {&base, &cell}) {
    reader->allow("contour");
    reader->allow("seed");
  }
  cell.allow("shape");
  base.allow_all_known(cell);
  base.finish();
  ASSERT_EQ(mistakes.size(), 1u);
  EXPECT_EQ(mistakes[0].text, "unknown key \"sigma\"; known: contour, seed, shape");
}

// Of 60 000 wrong keys in one line the first are shown, in the time of a line: what looks through
// all others at each of them takes minutes.
TEST(ManyMistakes, AreShownFromTheFirstAndCounted) {
  std::string yaml = "band: {low: 1, high: 2";
  for (int i = 0; i < 60000; ++i) yaml += fmt::format(", k{}: 1", i);
  const std::string text = mistakes_after_string(yaml + "}\n");
  EXPECT_NE(text.find("unknown key \"k0\""), std::string::npos);
  EXPECT_NE(text.find("unknown key \"k49\""), std::string::npos);
  EXPECT_EQ(text.find("unknown key \"k50\""), std::string::npos);
  EXPECT_NE(text.find("error: 59950 more: mend these first\n"), std::string::npos);
}

}  // namespace
}  // namespace modcal::reader_mistakes_test
