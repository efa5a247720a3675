#include "experiments/report/table.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "libsim/base/error.hpp"
#include "tests/experiments/report/sample_report.hpp"

namespace modcal::report::table_test {
namespace {

TEST(TableCsv, HasUnitsAllDigitsAndQuotes) {
  EXPECT_EQ(table_csv(noise_table()),
            "noise_percent [%],side,R_median,paper_R,comment\n"
            "0,1,0.84,0.81,record truncation\n"
            "1,1,0.72,0.71,\n"
            "8,2,0.31,0.48,outside; 'far'\n"
            "10,2,nan,0.45,not identifiable\n");
}

TEST(TableJson, IsAListOfRowsWithNullForWhatIsNoNumber) {
  const auto rows = nlohmann::json::parse(table_json(noise_table()));
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[0]["noise_percent"], 0.0);
  EXPECT_TRUE(rows[0]["side"].is_number_integer());
  EXPECT_TRUE(rows[1]["comment"].is_null());
  EXPECT_TRUE(rows[3]["R_median"].is_null());
  EXPECT_EQ(rows[2]["comment"], "outside, \"far\"");
}

TEST(TableCsv, KeepsTheValueThatThePageShowsInAnotherUnit) {
  Table table{.id = "t", .columns = {{.key = "x_c", .unit = "m"}}, .rows = {{0.030000214}}};
  table.rows[0][0].shown = "30.0002";
  EXPECT_EQ(cell_text(table.rows[0][0], table.columns[0]), "30.0002");
  EXPECT_EQ(table_csv(table), "x_c [m]\n0.030000214\n");
}

TEST(TableJson, KeepsEveryDigit) {
  const double third = 1.0 / 3.0;
  const Table table{.id = "t",
                    .title = "",
                    .caption = "",
                    .columns = {{.key = "a", .name = ""}},
                    .rows = {{third}},
                    .command = ""};
  EXPECT_EQ(nlohmann::json::parse(table_json(table))[0]["a"].get<double>(), third);
  EXPECT_EQ(std::stod(table_csv(table).substr(2)), third);
}

TEST(CellText, FollowsTheColumn) {
  const Column column{.key = "R", .name = "", .format = "{:.2f}"};
  EXPECT_EQ(cell_text(0.126, column), "0.13");
  EXPECT_EQ(cell_text(std::numeric_limits<double>::quiet_NaN(), column), "NaN");
  EXPECT_EQ(cell_text(3, column), "3");
  EXPECT_EQ(cell_text(true, column), "yes");
  EXPECT_EQ(cell_text("text", column), "text");
  EXPECT_EQ(cell_text({}, column), "–");
}

TEST(CheckTable, RefusesWhatCannotBeWritten) {
  EXPECT_NO_THROW(check_table(noise_table()));
  Table table = noise_table();
  table.rows[1].pop_back();
  EXPECT_THROW(check_table(table), InvalidInput);
  table = noise_table();
  table.columns[1].key = "noise_percent";
  EXPECT_THROW(check_table(table), InvalidInput);
  table = noise_table();
  table.columns[1].format = "{:d}";
  EXPECT_THROW(check_table(table), InvalidInput);
  table = noise_table();
  table.id = "a/b";
  EXPECT_THROW(check_table(table), InvalidInput);
  table = noise_table();
  table.columns.clear();
  EXPECT_THROW(check_table(table), InvalidInput);
}

}  // namespace
}  // namespace modcal::report::table_test
