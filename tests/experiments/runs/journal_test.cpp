#include "experiments/runs/journal.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <sstream>

#include "libsim/base/error.hpp"
#include "tests/folder_test.hpp"

namespace modcal::journal_test {
namespace {

using ::testing::HasSubstr;

struct JournalContents {
  std::vector<JournalRecord> records;
  std::vector<JournalDamage> damages;
};

void read_into(const std::filesystem::path& file, JournalContents& contents) {
  scan_journal(
      file,
      [&contents](const JournalRecord& record, std::uint64_t, std::size_t) {
        contents.records.push_back(record);
      },
      contents.damages);
}

JournalContents read_journal(const std::filesystem::path& file) {
  JournalContents contents;
  read_into(file, contents);
  return contents;
}

// In the order of the files' names and lines.
JournalContents read_journals(const std::filesystem::path& folder) {
  JournalContents contents;
  for (const std::filesystem::path& file : journals_in(folder)) read_into(file, contents);
  return contents;
}

class Journal : public FolderTest {
 protected:
  std::filesystem::path file() const { return folder() / "one.journal"; }

  static JournalRecord record(std::uint64_t task) {
    return {"0123456789abcdef0123456789abcde" + std::to_string(task % 10), task,
            0.1 * static_cast<double>(task),
            R"({"value": "a b", "task": )" + std::to_string(task) + "}"};
  }
  void write_records(std::uint64_t first, std::uint64_t last) const {
    JournalWriter writer(file(), "program 1");
    for (std::uint64_t task = first; task <= last; ++task) writer.append(record(task));
  }
  std::string bytes() const { return content_of(file()); }
  void replace(const std::string& bytes) const {
    std::ofstream(file(), std::ios::binary | std::ios::trunc) << bytes;
  }
};

void expect_equal(const JournalRecord& a, const JournalRecord& b) {
  EXPECT_EQ(a.key, b.key);
  EXPECT_EQ(a.task, b.task);
  EXPECT_EQ(a.seconds, b.seconds);
  EXPECT_EQ(a.outcome, b.outcome);
}

TEST_F(Journal, GivesBackWhatWasAppendedInSeveralRuns) {
  write_records(0, 2);
  write_records(3, 4);
  const JournalContents contents = read_journal(file());
  EXPECT_TRUE(contents.damages.empty());
  ASSERT_EQ(contents.records.size(), 5u);
  for (std::uint64_t task = 0; task < 5; ++task) expect_equal(contents.records[task], record(task));
}

TEST_F(Journal, CutAnywhereLosesAtMostTheRecordThatIsCutAndNamesIt) {
  write_records(0, 99);
  const std::string whole = bytes();
  for (std::size_t cut = 0; cut < whole.size(); ++cut) {
    replace(whole.substr(0, cut));
    const JournalContents contents = read_journal(file());
    // Lines that are complete in what is left, with or without their end; the first is the header.
    const bool between_lines = cut == 0 || whole[cut - 1] == '\n' || whole[cut] == '\n';
    const auto lines = static_cast<std::size_t>(
        std::count(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(cut), '\n') +
        (whole[cut] == '\n' ? 1 : 0));
    ASSERT_EQ(contents.records.size(), lines == 0 ? 0 : lines - 1) << cut;
    ASSERT_EQ(contents.damages.size(), between_lines ? 0u : 1u) << cut;
    if (between_lines) continue;
    EXPECT_EQ(contents.damages[0].line, lines + 1);
    EXPECT_THAT(message_of(contents.damages[0]),
                HasSubstr("is cut off; its task will be run again"));
  }
}

TEST_F(Journal, GoesOnAfterACutWithoutHarmToWhatFollows) {
  write_records(0, 3);
  const std::string whole = bytes();
  for (std::size_t cut = 0; cut <= whole.size(); ++cut) {
    replace(whole.substr(0, cut));
    const std::size_t before = read_journal(file()).records.size();
    write_records(7, 8);
    const JournalContents contents = read_journal(file());
    ASSERT_EQ(contents.records.size(), before + 2) << cut;
    expect_equal(contents.records[before], record(7));
    expect_equal(contents.records[before + 1], record(8));
  }
}

TEST_F(Journal, NoticesAChangedByteAnywhere) {
  write_records(0, 99);
  const std::string whole = bytes();
  const std::size_t first_record = whole.find('\n') + 1;
  for (std::size_t i = first_record; i < whole.size(); ++i) {
    std::string changed = whole;
    changed[i] = static_cast<char>(changed[i] ^ (1 << (i % 8)));
    replace(changed);
    const JournalContents contents = read_journal(file());
    // A changed line end joins two lines or, at the last one, leaves one without an end; a new one
    // makes two of a line.
    ASSERT_GE(contents.records.size(), whole[i] == '\n' ? 98u : 99u) << i;
    ASSERT_LE(contents.records.size(), 99u) << i;
    ASSERT_GE(contents.damages.size(), 1u) << i;
    for (const JournalRecord& one : contents.records) expect_equal(one, record(one.task));
  }
}

TEST_F(Journal, SaysWhatWroteItAndRefusesTheFormatOfAnotherVersion) {
  write_records(0, 0);
  EXPECT_THAT(bytes(), HasSubstr(" modcal-journal 1 program 1\n"));
  const std::string header = "modcal-journal 2 program 9";
  replace(checksum_of(header) + " " + header + "\n");
  EXPECT_THROW(read_journal(file()), InvalidInput);
}

TEST_F(Journal, ReadsAllJournalsOfAFolderInTheOrderOfTheirNames) {
  { JournalWriter(folder() / "b.journal", "p").append(record(1)); }
  { JournalWriter(folder() / "a.journal", "p").append(record(2)); }
  std::ofstream(folder() / "c.lock") << "not a journal";
  const JournalContents contents = read_journals(folder());
  ASSERT_EQ(contents.records.size(), 2u);
  EXPECT_EQ(contents.records[0].task, 2u);
  EXPECT_TRUE(read_journals(folder() / "missing").records.empty());
}

TEST_F(Journal, SaysWhatAFullDiskMeans) {
  JournalWriter writer(file(), "program");
  writer.append(record(0));
  const std::string before = bytes();
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
  const rlimit little{before.size() + 10, limit.rlim_max};  // a part of the next line
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &little), 0);
  std::string reason = "a full disk goes unnoticed";
  try {
    writer.append(record(1));
  } catch (const InvalidInput& error) {
    reason = error.what();
  }
  setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, handler);
  EXPECT_THAT(reason, HasSubstr("File too large; make room and run the same command again"));
  EXPECT_THAT(reason, HasSubstr("what the journal holds is not repeated"));
  EXPECT_EQ(bytes(), before);
}

TEST_F(Journal, NoticesThatItIsGone) {
  JournalWriter writer(file(), "program");
  writer.append(record(0));
  std::filesystem::rename(file(), folder() / "elsewhere");
  EXPECT_THROW(writer.append(record(1)), LostOutput);
}

TEST_F(Journal, NamesNoDamageWhoseTaskWasDoneAgain) {
  write_records(0, 3);
  std::string text = bytes();
  text[text.size() - 5] ^= 1;
  replace(text);
  ASSERT_EQ(read_journal(file()).damages.size(), 1u);
  {
    JournalWriter writer(file(), "program");
    writer.append(record(2));
    writer.declare_repaired();
  }
  EXPECT_TRUE(read_journal(file()).damages.empty());
  EXPECT_EQ(read_journal(file()).records.size(), 4u);
}

TEST_F(Journal, KeepsUnusualTimesAndLongOutcomes) {
  JournalRecord unusual = record(5);
  unusual.seconds = std::numeric_limits<double>::denorm_min();
  unusual.task = std::numeric_limits<std::uint64_t>::max();
  unusual.outcome = std::string(100000, 'x');
  { JournalWriter(file(), "p").append(unusual); }
  const JournalContents contents = read_journal(file());
  ASSERT_EQ(contents.records.size(), 1u);
  expect_equal(contents.records[0], unusual);
}

}  // namespace
}  // namespace modcal::journal_test
