// What people write wrong: each mistake is told with place, reason and remedy, in few lines, and
// with the exit code of its kind. The tables beside this file have one paragraph for each.
#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <vector>

#include "tests/experiments/cli/program_run.hpp"

namespace modcal::wrong_inputs_test {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A paragraph of a table: its lines by what they begin with.
struct Row {
  std::string name;
  std::map<char, std::vector<std::string>> lines;

  std::string text(char mark) const {
    std::string all;
    const auto found = lines.find(mark);
    if (found == lines.end()) return all;
    for (const std::string& line : found->second) all += line + "\n";
    return all;
  }
  std::string line(char mark) const {
    const std::string all = text(mark);
    return all.substr(0, all.find('\n'));
  }
};

std::vector<Row> rows_of(const std::string& table) {
  std::vector<Row> rows;
  std::istringstream stream(content_of(std::string(MODCAL_WRONG_INPUTS) + "/" + table));
  bool begins = true;
  for (std::string line; std::getline(stream, line);) {
    if (line.empty() || line[0] == '#') {
      begins = true;
    } else if (std::exchange(begins, false)) {
      rows.push_back({line, {}});
    } else {
      rows.back().lines[line[0]].push_back(line.size() > 2 ? line.substr(2) : "");
    }
  }
  return rows;
}

// "\n" and "\t" of a table as characters.
std::string unescaped(const std::string& text) {
  return std::regex_replace(std::regex_replace(text, std::regex(R"(\\n)"), "\n"),
                            std::regex(R"(\\t)"), "\t");
}

// Whether the pieces between "..." stand in the text one behind the other.
bool says(const std::string& text, const std::string& expected) {
  std::size_t from = 0;
  for (std::size_t at = 0; at <= expected.size();) {
    const std::size_t end = std::min(expected.find(" ... ", at), expected.size());
    const std::string piece = expected.substr(at, end - at);
    const std::size_t found = text.find(piece, from);
    if (found == std::string::npos) return false;
    from = found + piece.size();
    at = end + 5;
  }
  return true;
}

// The headings behind the comments that follow them.
std::string comments_first(const std::string& record) {
  const std::size_t headings = record.find('\n') + 1;
  std::size_t rows = headings;
  while (record[rows] == '#') rows = record.find('\n', rows) + 1;
  return record.substr(headings, rows - headings) + record.substr(0, headings) +
         record.substr(rows);
}

class WrongInputs : public testing::ProgramTest {
 protected:
  WrongInputs() {
    // Comments first, as many programs write them: the other order is read as well.
    std::ofstream(path("good.csv"))
        << comments_first(content_of(std::string(MODCAL_EXAMPLES) + "/bowed_violin_d.csv"));
    std::filesystem::copy_file(path("good.csv"), path("record.csv"));
    for (const Row& row : rows_of("bases.txt")) bases_[row.name] = row.text('|');
  }

  /// What the row's lines ">" say, and nothing else, within 20 lines.
  static void expect_told(const Row& row, const Outcome& outcome, int code) {
    SCOPED_TRACE(row.name + "\n" + outcome.err);
    EXPECT_EQ(outcome.code, code);
    EXPECT_LE(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 20);
    EXPECT_THAT(outcome.err, Not(HasSubstr("internal")));
    const std::regex told("(^|\n|: )(error|warning): ");
    const auto messages = std::distance(
        std::sregex_iterator(outcome.err.begin(), outcome.err.end(), told), std::sregex_iterator());
    const std::vector<std::string>& expected = row.lines.at('>');
    EXPECT_EQ(messages, std::ssize(expected));
    for (const std::string& line : expected) EXPECT_TRUE(says(outcome.err, line)) << line;
  }

  std::map<std::string, std::string> bases_;
};

TEST_F(WrongInputs, ExperimentFiles) {
  for (const auto& [name, text] : bases_) {
    write("wrong.yaml", text);
    const Outcome good = modcal("validate wrong.yaml");
    EXPECT_EQ(good.code, 0) << name;
    EXPECT_EQ(good.err, "") << name;
  }
  const std::vector<Row> rows = rows_of("files.txt");
  EXPECT_GE(rows.size(), 60u);
  for (const Row& row : rows) {
    std::string text = bases_.at(row.line('@'));
    const std::string old = unescaped(row.line('-'));
    ASSERT_THAT(text, HasSubstr(old)) << row.name;
    write("wrong.yaml", text.replace(text.find(old), old.size(), unescaped(row.line('+'))));
    const bool warns = row.line('>').find("warning: ") != std::string::npos;
    const Outcome outcome = modcal("validate wrong.yaml");
    expect_told(row, outcome, warns ? 0 : 3);
    EXPECT_EQ(outcome.out, warns ? outcome.out : "");
  }
}

TEST_F(WrongInputs, Records) {
  ASSERT_EQ(modcal("new calibrate record.csv --length '0.33 m' --out wrong.yaml").code, 0);
  const std::vector<Row> rows = rows_of("records.txt");
  EXPECT_GE(rows.size(), 40u);
  for (const Row& row : rows) {
    ASSERT_EQ(shell(row.line('$')).code, 0) << row.name;
    expect_told(row, modcal("validate wrong.yaml"), 3);
  }
}

TEST_F(WrongInputs, CommandLines) {
  write("small.yaml", bases_.at("simulate"));
  write("list.yaml", bases_.at("simulate") + "sweep:\n  product:\n    seed: [1, 2, 3]\n");
  ASSERT_EQ(modcal("run list.yaml --out listed").code, 0);
  const std::vector<Row> rows = rows_of("commands.txt");
  EXPECT_GE(rows.size(), 40u);
  for (const Row& row : rows) {
    const int code = std::stoi(row.line('!'));
    const Outcome outcome = modcal(row.name);
    expect_told(row, outcome, code);
    EXPECT_EQ(outcome.out, "") << row.name;
    // The same for programs.
    std::string words = row.name;
    words.insert(std::min(words.find(' '), words.size()), " --json");
    const Outcome answer = modcal(words);
    EXPECT_EQ(answer.code, code) << row.name;
    const auto error = nlohmann::json::parse(answer.out, nullptr, false);
    ASSERT_FALSE(error.is_discarded()) << row.name << answer.out;
    EXPECT_EQ(error["error"]["exit_code"], code) << row.name;
    const std::string told = std::regex_replace(answer.err, std::regex("error: "), "");
    EXPECT_THAT(told, HasSubstr(error["error"]["message"])) << row.name;
  }
}

}  // namespace
}  // namespace modcal::wrong_inputs_test
