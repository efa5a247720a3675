// A folder of its own for every test.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "libsim/base/error.hpp"

namespace modcal {

class RecordFolder : public testing::Test {
 protected:
  RecordFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "modcal_test_XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
  }
  ~RecordFolder() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  std::filesystem::path path(std::string_view name) const { return folder_ / name; }
  std::filesystem::path write(std::string_view name, std::string_view content) const {
    std::ofstream(path(name), std::ios::binary) << content;
    return path(name);
  }
  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

/// The text of the InvalidInput that `call` throws; empty where it throws none.
template <typename Call>
std::string refusal(Call call) {
  try {
    call();
  } catch (const InvalidInput& error) {
    return error.what();
  }
  return {};
}

}  // namespace modcal
