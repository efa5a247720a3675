// Runs the program as a user does and keeps what it says.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace modcal::testing {

inline std::string content_of(const std::filesystem::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

/// A test with a folder of its own.
class ProgramTest : public ::testing::Test {
 protected:
  struct Outcome {
    int code = -1;
    std::string out;
    std::string err;
  };

  ProgramTest() {
    std::string name = (std::filesystem::temp_directory_path() / "modcal-test-XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~ProgramTest() override { std::filesystem::remove_all(folder_); }

  const std::filesystem::path& folder() const { return folder_; }

  /// `modcal` followed by `arguments`, words of a shell, in the test's folder.
  Outcome modcal(const std::string& arguments) const {
    return shell("'" MODCAL_PROGRAM "' " + arguments);
  }
  Outcome shell(const std::string& command) const {
    const std::string line = "cd '" + folder_.string() + "' && { " + command + "; } >.out 2>.err";
    const int status = std::system(line.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, content_of(folder_ / ".out"),
            content_of(folder_ / ".err")};
  }
  void write(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
  }

 private:
  std::filesystem::path folder_;
};

}  // namespace modcal::testing
