#include "experiments/runs/results_database.hpp"

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <cstdlib>

#include "libsim/base/error.hpp"
#include "tests/folder_test.hpp"

namespace modcal::results_database_test {
namespace {

std::vector<ResultRow> rows() {
  return {{0, {"0 %", "it's"}, "", R"({"R":0.5})", 0.25},
          {2, {"1 %", "\"b\""}, "no minimum", R"({"failure":"no minimum"})", 0.5}};
}

std::string write_results_database(const std::filesystem::path& file,
                                   const std::vector<std::string>& axes,
                                   const std::vector<ResultRow>& rows,
                                   const std::vector<std::pair<std::string, std::string>>& facts) {
  ResultsDatabase database(file, axes);
  for (const ResultRow& row : rows) database.add(row);
  return database.finish(facts);
}

std::string digest_of_rows(const std::vector<std::string>& axes,
                           const std::vector<ResultRow>& rows) {
  RowsDigest digest(axes);
  for (const ResultRow& row : rows) digest.add(row);
  return digest.text();
}

// Text of one value of the database, "NULL" for none.
std::string ask(const std::filesystem::path& file, const std::string& sql) {
  sqlite3* database = nullptr;
  sqlite3_open_v2(file.c_str(), &database, SQLITE_OPEN_READONLY, nullptr);
  sqlite3_stmt* statement = nullptr;
  std::string answer = "no row";
  if (sqlite3_prepare_v2(database, sql.c_str(), -1, &statement, nullptr) != SQLITE_OK) {
    answer = sqlite3_errmsg(database);
  } else if (sqlite3_step(statement) == SQLITE_ROW) {
    const unsigned char* text = sqlite3_column_text(statement, 0);
    answer = text == nullptr ? "NULL" : reinterpret_cast<const char*>(text);
  }
  sqlite3_finalize(statement);
  sqlite3_close(database);
  return answer;
}

class ResultsDatabaseFile : public FolderTest {};

TEST_F(ResultsDatabaseFile, AnswersQuestionsAboutTheRows) {
  const std::filesystem::path file = path("results.sqlite");
  const std::string digest =
      write_results_database(file, {"noise", "strange \" name"}, rows(), {{"kind", "sweep"}});
  EXPECT_EQ(ask(file, "SELECT count(*) FROM tasks"), "2");
  EXPECT_EQ(ask(file, "SELECT \"strange \"\" name\" FROM tasks WHERE task = 0"), "it's");
  EXPECT_EQ(ask(file, "SELECT failure FROM tasks WHERE task = 0"), "NULL");
  EXPECT_EQ(ask(file, "SELECT failure FROM tasks WHERE task = 2"), "no minimum");
  EXPECT_EQ(ask(file, "SELECT json_extract(outcome, '$.R') FROM tasks WHERE task = 0"), "0.5");
  EXPECT_EQ(ask(file, "SELECT sum(seconds) FROM timing"), "0.75");
  EXPECT_EQ(ask(file, "SELECT value FROM run WHERE name = 'kind'"), "sweep");
  EXPECT_EQ(ask(file, "SELECT value FROM run WHERE name = 'digest'"), digest);
  // Written again over the first.
  write_results_database(file, {"noise", "x"}, {}, {});
  EXPECT_EQ(ask(file, "SELECT count(*) FROM tasks"), "0");
  std::filesystem::remove_all(folder());
  EXPECT_THROW(write_results_database(file, {}, rows(), {}), InvalidInput);
}

TEST(ResultsDatabase, DigestDependsOnEveryValueButTheTimes) {
  const std::string digest = digest_of_rows({"noise", "x"}, rows());
  std::vector<ResultRow> slower = rows();
  slower[0].seconds = 9.0;
  EXPECT_EQ(digest_of_rows({"noise", "x"}, slower), digest);
  std::vector<ResultRow> other = rows();
  other[0].axis_values = {"0 %i", "t's"};  // the same letters, parted elsewhere
  EXPECT_NE(digest_of_rows({"noise", "x"}, other), digest);
  other = rows();
  other[1].task = 1;
  EXPECT_NE(digest_of_rows({"noise", "x"}, other), digest);
  EXPECT_NE(digest_of_rows({"noise", "y"}, rows()), digest);
}

}  // namespace
}  // namespace modcal::results_database_test
