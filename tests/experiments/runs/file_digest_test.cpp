#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "experiments/runs/journal.hpp"
#include "tests/folder_test.hpp"

namespace modcal::file_digest_test {
namespace {

namespace fs = std::filesystem;

class FileDigest : public FolderTest {
 protected:
  FileDigest() { write("0.1 0.2 0.3"); }

  fs::path file() const { return folder() / "record.csv"; }
  void write(const std::string& text) const { FolderTest::write("record.csv", text); }
};

TEST_F(FileDigest, TellsAnExchangedFileOfTheSameSizeAndTime) {
  const std::string before = input_digest(file());
  const auto time = fs::last_write_time(file());
  write("0.1 0.2 0.4");
  fs::last_write_time(file(), time);
  EXPECT_NE(input_digest(file()), before);
  write("0.1 0.2 0.3");
  EXPECT_EQ(input_digest(file()), before);
}

TEST_F(FileDigest, IsThatOfTheContentWhereverItStands) {
  const std::string before = input_digest(file());
  fs::rename(file(), file().string() + ".old");
  EXPECT_EQ(input_digest(file()), "missing");
  fs::copy(file().string() + ".old", file());
  EXPECT_EQ(input_digest(file()), before);
  EXPECT_EQ(input_digest(file().parent_path()), "missing");
  // Longer than a block that is read at once.
  write(std::string(1 << 20, 'x'));
  const std::string longer = digest_of_file(file());
  write(std::string((1 << 20) + 1, 'x'));
  EXPECT_NE(digest_of_file(file()), longer);
}

}  // namespace
}  // namespace modcal::file_digest_test
