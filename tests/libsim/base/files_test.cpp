#include "libsim/base/files.hpp"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>

#include "libsim/base/error.hpp"
#include "tests/folder_test.hpp"
#include "tests/refusal.hpp"

namespace modcal::files_test {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class Files : public FolderTest {
 protected:
  std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (const auto& entry : fs::directory_iterator(folder())) {
      found.push_back(entry.path().filename().string());
    }
    return found;
  }
};

TEST_F(Files, RefusesWhatIsNoFileWithoutOpeningIt) {
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  fs::create_symlink("/dev/zero", path("zero"));
  EXPECT_THAT(refusal_of([&] { content_of_file(path("pipe")); }), HasSubstr("this is a pipe"));
  EXPECT_THAT(refusal_of([&] { content_of_file(path("zero")); }), HasSubstr("this is a device"));
  EXPECT_THAT(refusal_of([&] { content_of_file(folder()); }), HasSubstr("this is a folder"));
  EXPECT_THAT(refusal_of([&] { OpenFile::for_reading(path("pipe"), "the journal"); }),
              HasSubstr("the journal is a pipe, not a file"));
  EXPECT_EQ(content_of_file(write("a", "text")), "text");
}

TEST_F(Files, TakesNoFailedReadForTheEndOfAFile) {
  // A file whose first byte cannot be read.
  EXPECT_THAT(refusal_of([] { content_of_file("/proc/self/mem"); }),
              HasSubstr("cannot be read: Input/output error"));
}

TEST_F(Files, AppendsToNoFileOfOthers) {
  const fs::path victim = write("victim", "kept");
  fs::create_symlink(victim, path("symbolic"));
  fs::create_hard_link(victim, path("hard"));
  ASSERT_EQ(mkfifo(path("pipe").c_str(), 0600), 0);
  const auto open = [&](const char* name) {
    return refusal_of([&] { OpenFile::for_appending(path(name), "the lock"); });
  };
  EXPECT_THAT(open("symbolic"), HasSubstr("the lock is a link"));
  EXPECT_THAT(open("hard"), HasSubstr("a second name elsewhere"));
  EXPECT_THAT(open("pipe"), HasSubstr("the lock is a pipe"));
  EXPECT_EQ(content_of_file(victim), "kept");
  if (geteuid() == 0) {
    ASSERT_EQ(chown(write("foreign", "kept").c_str(), 12345, 12345), 0);
    EXPECT_THAT(open("foreign"), HasSubstr("belongs to somebody else (user 12345)"));
    // Whoever owns the folder may have its files gone on with.
    ASSERT_EQ(chown(folder().c_str(), 12345, 12345), 0);
    EXPECT_NO_THROW(OpenFile::for_appending(path("foreign"), "the lock"));
  }
  EXPECT_NO_THROW(OpenFile::for_appending(path("new"), "the lock"));
}

TEST_F(Files, NoticesThatAFileIsGone) {
  const OpenFile file = OpenFile::for_appending(path("a"), "the journal");
  const OpenFile whole = OpenFile::folder(folder(), "the folder");
  EXPECT_NO_THROW(file.require_in_place("the journal"));
  fs::rename(path("a"), path("b"));
  EXPECT_THROW(file.require_in_place("the journal"), LostOutput);
  write("a", "another one");
  EXPECT_THROW(file.require_in_place("the journal"), LostOutput);
  fs::rename(path("b"), path("a"));
  EXPECT_NO_THROW(file.require_in_place("the journal"));
  EXPECT_NO_THROW(whole.require_in_place("the folder"));
  fs::rename(folder(), folder().string() + "-moved");
  EXPECT_THROW(whole.require_in_place("the folder"), LostOutput);
  fs::rename(folder().string() + "-moved", folder());
}

TEST_F(Files, ReplacesAFileWholeOrNotAtAll) {
  write("a", "old");
  {
    const PartFile part(path("a"));
    std::ofstream(part.path()) << "half";
    EXPECT_EQ(names().size(), 2u);
  }
  EXPECT_EQ(content_of_file(path("a")), "old");
  PartFile part(path("a"));
  std::ofstream(part.path()) << "new";
  part.put_in_place();
  EXPECT_EQ(content_of_file(path("a")), "new");
  EXPECT_EQ(names().size(), 1u);
}

TEST_F(Files, RemovesPartsOfKilledProcessesAlone) {
  const PartFile written(path("in_work"));
  const auto an_hour_ago = fs::file_time_type::clock::now() - std::chrono::hours(1);
  const std::string in_work = written.path().filename().string();
  fs::last_write_time(written.path(), an_hour_ago);
  for (const char* name : {"a.csv.4711.part", "report.html.0badcafe.part", "fig.svg.part", "x.part",
                           "resolved.yaml"}) {
    fs::last_write_time(write(name, "half"), an_hour_ago);
  }
  write("young.csv.4711.part", "half");
  remove_abandoned_parts(folder(), "a.csv");
  EXPECT_EQ(names().size(), 6u);
  remove_abandoned_parts(folder());
  EXPECT_THAT(names(), ::testing::UnorderedElementsAre(in_work, "fig.svg.part", "x.part",
                                                       "resolved.yaml", "young.csv.4711.part"));
}

TEST_F(Files, TestsAFolderWithoutTouchingWhatIsThere) {
  const fs::path victim = write("victim", "kept");
  fs::create_symlink(victim, path(".modcal-write-test"));
  EXPECT_EQ(why_not_writable(folder()), "");
  EXPECT_EQ(content_of_file(victim), "kept");
  EXPECT_EQ(names().size(), 2u);
  EXPECT_NE(why_not_writable("/proc"), "");
}

}  // namespace
}  // namespace modcal::files_test
