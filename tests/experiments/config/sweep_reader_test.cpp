#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "experiments/config/reader.hpp"

namespace modcal::sweep_reader_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Cells as "a=1 b=2", unset values left out; or the mistakes.
std::vector<std::string> cells(const std::string& yaml) {
  const YamlDocument document = parse_yaml(yaml, "a.yaml");
  std::vector<Mistake> found = document.mistakes;
  const SweepTable table = read_sweep(document.root, "sweep", found);
  std::vector<std::string> lines;
  for (const Mistake& mistake : found) {
    lines.push_back(
        fmt::format("{}:{}: {}", mistake.position.line, mistake.position.column, mistake.text));
  }
  if (!lines.empty()) {
    EXPECT_TRUE(table.values.empty());
    return lines;
  }
  const SweepCells swept = table.cells();
  for (const std::vector<std::string>& values : swept.values) {
    std::vector<std::string> parts;
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!values[i].empty()) parts.push_back(swept.paths[i] + "=" + values[i]);
    }
    lines.push_back(fmt::format("{}", fmt::join(parts, " ")));
  }
  return lines;
}

TEST(SweepReader, CombinesAxesTheLastFastest) {
  EXPECT_THAT(cells("product: {a: [1, 2], b: [x, y]}"),
              ElementsAre("a=1 b=x", "a=1 b=y", "a=2 b=x", "a=2 b=y"));
}

TEST(SweepReader, VariesZippedAxesTogetherAndCombinesTheGroups) {
  EXPECT_THAT(cells("product: {a: [1, 2]}\nzip:\n  - {b: [3, 4], c: [5, 6]}"),
              ElementsAre("a=1 b=3 c=5", "a=1 b=4 c=6", "a=2 b=3 c=5", "a=2 b=4 c=6"));
  EXPECT_THAT(cells("zip:\n  - {a: [1, 2], b: [3, 4]}\n  - {c: [5, 6]}"),
              ElementsAre("a=1 b=3 c=5", "a=1 b=3 c=6", "a=2 b=4 c=5", "a=2 b=4 c=6"));
}

TEST(SweepReader, LeavesOutAndAddsCells) {
  EXPECT_THAT(cells("product: {a: [1, 2], b: [3, 4]}\nexclude: [{a: 1, b: 4}, {a: 2, b: 3}]\n"
                    "include: [{b: 9, c: 30 mm}, {a: 7}]"),
              ElementsAre("a=1 b=3", "a=2 b=4", "b=9 c=30 mm", "a=7"));
  EXPECT_THAT(cells("product: {a: [1, 2], b: [3, 4]}\nexclude: [{a: 1}]"),
              ElementsAre("a=2 b=3", "a=2 b=4"));
  EXPECT_THAT(cells("include: [{a: 1}, {b: 2}]"), ElementsAre("a=1", "b=2"));
}

TEST(SweepReader, TakesPluginsWithTheirOptionsAsValues) {
  EXPECT_THAT(cells("product: {a: [grid, {type: nlopt, algorithm: LN_SBPLX, at: [1, 'x, y']}]}"),
              ElementsAre("a=grid", R"(a={type: nlopt, algorithm: LN_SBPLX, at: [1, "x, y"]})"));
  EXPECT_THAT(cells("product: {a: [{type: x}, {type: y}]}\nexclude: [{a: {type: x}}]"),
              ElementsAre("a={type: y}"));
}

// Else a section would take the place of what the axis before has put into it.
TEST(SweepReader, PutsASectionInBeforeWhatLiesInIt) {
  EXPECT_THAT(outer_first({"m.noise", "seed", "m", "m.noise.color"}), ElementsAre(1, 2, 0, 3));
  EXPECT_THAT(cells("product: {m.noise: [1, 2], m: [{rate: 40}]}"),
              ElementsAre("m.noise=1 m={rate: 40}", "m.noise=2 m={rate: 40}"));
  EXPECT_THAT(
      cells("product: {m.noise: [1, 2], m: [{rate: 40}, {noise: 3}]}"),
      ElementsAre("1:52: m.noise is an axis of its own: leave it out here, or that axis out"));
}

// What stands there twice would be a draw that counts twice.
TEST(SweepReader, RefusesACellThatStandsThereAlready) {
  EXPECT_THAT(cells("product: {a: [1, 2], b: [3]}\ninclude: [{a: 2, b: 3}]"),
              ElementsAre("2:15: the cell {a: 2, b: 3} stands in the list already, and its draw "
                          "would count twice: leave it out"));
  EXPECT_THAT(cells("include: [{a: 1}, {a: 1}]")[0], HasSubstr("stands in the list already"));
  EXPECT_THAT(cells("product: {a: [1]}\nexclude: [{a: 1}]\ninclude: [{a: 1}]"), ElementsAre("a=1"));
}

TEST(SweepReader, NamesMistakesWithTheirPlaces) {
  EXPECT_THAT(cells("zip: [{a: [1, 2], b: [3]}]"),
              ElementsAre("1:19: b has 1 values, a has 2: values that vary together are as many"));
  EXPECT_THAT(cells("product: {a: [1]}\nzip: [{a: [2]}]"),
              ElementsAre("2:8: a is an axis already"));
  EXPECT_THAT(cells("product: {a: [1]}\nexclude: [{b: 1}]"),
              ElementsAre("2:11: b is no axis; axes: a"));
  EXPECT_THAT(
      cells("product: {a: [1]}\nexclude: [{a: 1.0}]"),
      ElementsAre("2:11: no cell agrees with this: write the values as they stand on the axes"));
  EXPECT_THAT(cells("product: {a: [1]}\nexclude: [{a: 1}]"),
              ElementsAre("1:1: the sweep has no cells left: exclude fewer of them"));
  EXPECT_THAT(cells("produkt: {a: [1]}"),
              ElementsAre("1:1: unknown key \"produkt\"; known: product, zip, exclude, include"));
  EXPECT_THAT(cells("product: {a: 1}"),
              ElementsAre("1:14: a needs a list of values, at least one"));
  EXPECT_THAT(cells("zip: {a: [1]}"),
              ElementsAre("1:6: zip needs a list of maps, each beginning with a dash"));
  EXPECT_THAT(cells("exclude: [{a: 1}]")[0],
              HasSubstr("sweep needs a product, a zip or an include"));
  EXPECT_THAT(cells("product: {a: [1, 2, 1, 1]}"),
              ElementsAre("1:21: a 1 stands here twice: leave one of them"));
  EXPECT_THAT(cells("zip: [{a: [1, 1, 1], b: [1, 2, 1]}]"),
              ElementsAre("1:18: a 1, b 1 stands here twice: leave one of them"));
  EXPECT_THAT(cells("product: {kind: [a]}")[0], HasSubstr("kind is no axis"));
  EXPECT_THAT(cells("product: {sweep: [1, foo]}")[0], HasSubstr("sweep is no axis"));
  EXPECT_THAT(cells("zip: [{sweep.product: [1]}]")[0], HasSubstr("sweep is no axis"));
  EXPECT_THAT(cells("include: [{a: 1, title: b}]")[0], HasSubstr("title is no axis"));
  std::vector<int> numbers(1001);
  std::iota(numbers.begin(), numbers.end(), 0);
  const std::string many = fmt::format("{}", fmt::join(numbers, ", "));
  EXPECT_THAT(cells(fmt::format("product: {{a: [{0}], b: [{0}]}}", many)),
              ElementsAre("1:1: the sweep has more than 1000000 cells"));
}

}  // namespace
}  // namespace modcal::sweep_reader_test
