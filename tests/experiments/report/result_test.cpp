// One description of a result: JSON both ways, tables.
#include "experiments/report/result.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

namespace modcal::report::result_test {
namespace {

using testing::HasSubstr;

enum class Stop { kConverged, kBudget };
std::string_view name_of(Stop stop) { return stop == Stop::kBudget ? "budget" : "converged"; }

struct Mode {
  int number = 0;
  double frequency = 0.0;
  std::optional<double> deviation = {};
  void visit(ResultVisitor& visitor) {
    visitor({.key = "n", .name = "mode"}, number);
    visitor({.key = "f_hz", .unit = "Hz", .format = "{:.1f}"}, frequency);
    visitor({.key = "sd", .shown = ResultVisitor::kInTables}, "computed");
    visitor({.key = "f_sd_hz", .unit = "Hz"}, deviation);
  }
};

struct Found {
  Stop stop = Stop::kBudget;
  bool right = true;
  std::string failure = {};
  double value = 0.0;
  std::vector<Mode> modes = {};
  std::array<double, 2> noise = {};
  std::vector<std::pair<std::int64_t, double>> trace = {};
  void visit(ResultVisitor& visitor) {
    visitor({.key = "failure", .optional = true}, failure);
    visitor.word({.key = "stop"}, stop, Stop::kBudget);
    visitor.group({.table = "search", .name = "Search"}, [this](ResultVisitor& members) {
      members({.key = "right"}, right);
      members({.key = "value", .unit = "N"}, value);
    });
    visitor({.key = "modes", .table = "modes", .name = "Modes", .meaning = "All of them."}, modes);
    visitor({.key = "noise"}, noise);
    visitor({.key = "trace"}, trace);
  }
};

Found example() {
  return {.value = 1.0 / 3.0,
          .modes = {{1, 100.0, 0.5}, {2, std::numeric_limits<double>::infinity(), {}}},
          .noise = {0.25, std::nan("")},
          .trace = {{3, 1.5}}};
}

TEST(JsonOfAResult, HasItsValuesUnderTheirKeys) {
  EXPECT_EQ(json_of(example()).dump(),
            R"({"stop":"budget","right":true,"value":0.3333333333333333,"modes":[)"
            R"({"n":1,"f_hz":100.0,"f_sd_hz":0.5},{"n":2,"f_hz":null,"f_sd_hz":null}],)"
            R"("noise":[0.25,null],"trace":[[3,1.5]]})");
}

TEST(JsonOfAResult, GivesEveryBitBack) {
  const std::string line = json_line(example());
  const auto found = read_line<Found>(line, "the result");
  EXPECT_EQ(json_line(found), line);
  EXPECT_EQ(found.value, 1.0 / 3.0);
  EXPECT_TRUE(std::isinf(found.modes.at(1).frequency));
  EXPECT_TRUE(std::isnan(found.noise[1]));
  EXPECT_FALSE(found.modes[1].deviation);
}

TEST(JsonOfAResult, IsRefusedWhereAValueIsMissingOrUnknown) {
  const auto reason = [](const std::string& text) -> std::string {
    try {
      read_line<Found>(text, "the result");
    } catch (const InvalidInput& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_THAT(reason(R"({"stop":"budget"})"), HasSubstr("the result cannot be read: "));
  EXPECT_THAT(reason("{"), HasSubstr("the result cannot be read: "));
  EXPECT_THAT(reason(R"({"stop":"rain"})"), HasSubstr("unknown stop \"rain\""));
}

TEST(TablesOfAResult, AreThoseThatItNames) {
  Found found = example();
  const auto tables = tables_of([&](ResultVisitor& visitor) { found.visit(visitor); });
  ASSERT_EQ(tables.size(), 2u);
  EXPECT_EQ(table_csv(tables[0]), "right,value [N]\ntrue,0.3333333333333333\n");
  EXPECT_EQ(table_csv(tables[1]),
            "n,f_hz [Hz],sd,f_sd_hz [Hz]\n1,100,computed,0.5\n2,inf,computed,\n");
  EXPECT_EQ(tables[1].title, "Modes");
  EXPECT_EQ(tables[1].caption, "All of them.");
  EXPECT_EQ(cell_text(tables[1].rows[0][1], tables[1].columns[1]), "100.0");
}

TEST(TableOfRows, HasItsColumnsWithoutAnyRow) {
  const Table table = table_of({.id = "modes"}, std::vector<Mode>(),
                               [](RowWriter& row, Mode mode) { mode.visit(row); });
  EXPECT_EQ(table_csv(table), "n,f_hz [Hz],sd,f_sd_hz [Hz]\n");
}

}  // namespace
}  // namespace modcal::report::result_test
