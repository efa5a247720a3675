#include "experiments/runs/run_store.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>

#include "libsim/base/error.hpp"
#include "tests/folder_test.hpp"

namespace modcal::run_store_test {
namespace {

using ::testing::HasSubstr;

class Store : public FolderTest {};

void finish(RunStore& store, const std::string& fingerprint) {
  store.append({store.finished().key_of(fingerprint), 0, 0.1, "{}"});
}

TEST_F(Store, FindsWhatAnEarlierRunOfTheSameProgramFinished) {
  {
    RunStore store(folder(), {}, "program 1");
    EXPECT_FALSE(store.finished().find(store.finished().key_of("a")).is_known());
    finish(store, "a");
  }
  const RunStore again(folder(), {}, "program 1");
  EXPECT_TRUE(again.finished().find(again.finished().key_of("a")).is_known());
  EXPECT_FALSE(again.finished().find(again.finished().key_of("b")).is_known());
}

TEST_F(Store, TakesNothingFromAnotherProgram) {
  {
    RunStore store(folder(), {}, "program 1");
    finish(store, "a");
  }
  const RunStore again(folder(), {}, "program 2");
  EXPECT_FALSE(again.finished().find(again.finished().key_of("a")).is_known());
}

TEST_F(Store, RefusesASecondRunInTheSameFolderAndNamesTheFirst) {
  EXPECT_FALSE(is_running(journal_folder(folder())));
  std::optional<RunStore> first(std::in_place, folder(), Shard{}, "p");
  EXPECT_TRUE(is_running(journal_folder(folder())));
  try {
    const RunStore second(folder(), {}, "p");
    FAIL() << "two runs work in one folder";
  } catch (const InvalidInput& error) {
    EXPECT_THAT(error.what(), HasSubstr("another run works in " + folder().string()));
    EXPECT_THAT(error.what(), HasSubstr("process " + std::to_string(getpid())));
  }
  EXPECT_THROW(RunStore(folder(), Shard{1, 2}, "p"), InvalidInput);
  first.reset();
  EXPECT_FALSE(is_running(journal_folder(folder())));
  EXPECT_NO_THROW(RunStore(folder(), {}, "p"));
}

TEST_F(Store, ReadsRecordsOfItsOwnAndOfEarlierRunsFromTheirPlaces) {
  RecordPlace first;
  {
    RunStore store(folder(), {}, "p");
    store.append({store.finished().key_of("a"), 3, 0.5, "{\"x\":1}"});
    first = store.append({store.finished().key_of("b"), 4, 0.25, "{\"x\":2}"});
    EXPECT_EQ(store.finished().read(first).outcome, "{\"x\":2}");
  }
  const RunStore again(folder(), {}, "p");
  const FinishedTasks& finished = again.finished();
  const JournalRecord record = finished.read(finished.find(finished.key_of("a")));
  EXPECT_EQ(record.task, 3u);
  EXPECT_EQ(record.seconds, 0.5);
  EXPECT_EQ(record.outcome, "{\"x\":1}");
  // A line that has changed since it was placed is not taken for a result.
  std::filesystem::resize_file(journal_folder(folder()) / "shard-1-of-1.journal", 40);
  EXPECT_THROW(finished.read(finished.find(finished.key_of("b"))), InvalidInput);
}

TEST_F(Store, LetsDifferentShardsShareAFolder) {
  const RunStore first(folder(), {1, 2}, "p");
  const RunStore second(folder(), {2, 2}, "p");
  EXPECT_THROW(RunStore(folder(), Shard{2, 2}, "p"), InvalidInput);
  EXPECT_THROW(RunStore(folder(), Shard{}, "p"), InvalidInput);
}

TEST_F(Store, KeepsAFolderForOneRun) {
  {
    const FolderLock whole(folder(), {});
    EXPECT_THROW(FolderLock(folder(), Shard{}), InvalidInput);
    EXPECT_THROW(FolderLock(folder(), Shard{1, 2}), InvalidInput);
  }
  const FolderLock first(folder(), {1, 2}), second(folder(), {2, 2});
  EXPECT_THROW(FolderLock(folder(), Shard{}), InvalidInput);
}

TEST(ShardOption, ReadsAndRefuses) {
  EXPECT_EQ(parse_shard("2/7").index, 2u);
  EXPECT_EQ(parse_shard("2/7").count, 7u);
  for (const char* wrong : {"", "2", "0/7", "8/7", "2/0", "-1/3", "2/7x", "a/b", "1/", "/1"}) {
    EXPECT_THROW(parse_shard(wrong), InvalidInput) << wrong;
  }
}

TEST(ShardOption, SharesOutEveryTaskOnce) {
  for (std::size_t tasks = 0; tasks < 20; ++tasks) {
    std::vector<int> times(tasks, 0);
    for (std::size_t index = 1; index <= 7; ++index) {
      const Shard shard{index, 7};
      std::size_t held = 0;
      for (std::size_t task = 0; task < tasks; ++task) {
        if (!shard.holds(task)) continue;
        ++times[task];
        ++held;
      }
      EXPECT_EQ(held, shard.size(tasks));
    }
    for (const int count : times) EXPECT_EQ(count, 1);
  }
}

}  // namespace
}  // namespace modcal::run_store_test
