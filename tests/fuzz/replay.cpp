// In the place of libFuzzer where there is none: every file of the folders once.
#include <cstdint>
#include <cstdio>
#include <vector>

#include "tests/folder_test.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

int main(int argc, char** argv) {
  std::vector<std::filesystem::path> files;
  for (int i = 1; i < argc; ++i) {
    if (argv[i][0] == '-') continue;  // an option of libFuzzer
    for (const auto& entry : std::filesystem::directory_iterator(argv[i])) {
      files.push_back(entry.path());
    }
  }
  for (const std::filesystem::path& file : files) {
    const std::string text = modcal::content_of(file);
    std::fprintf(stderr, "%s\n", file.c_str());
    LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  }
  std::printf("Done %zu runs\n", files.size());
  return files.empty() ? 1 : 0;
}
