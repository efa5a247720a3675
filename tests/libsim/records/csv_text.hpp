// A CSV file of some rows, read, or why it is not.
#pragma once

#include <string>
#include <string_view>

#include "libsim/records/record_file.hpp"
#include "tests/folder_test.hpp"
#include "tests/refusal.hpp"

namespace modcal {

class CsvText : public FolderTest {
 protected:
  Recording read(std::string_view content, const ReadOptions& options = {}) const {
    return read_csv(write("r.csv", content), options);
  }
  /// The message for this content, with the folder cut off.
  std::string error(std::string_view content, const ReadOptions& options = {}) const {
    std::string text = refusal_of([&] { read(content, options); });
    const std::string prefix = folder().string() + "/";
    for (std::size_t at; (at = text.find(prefix)) != std::string::npos;) {
      text.erase(at, prefix.size());
    }
    return text;
  }
};

}  // namespace modcal
