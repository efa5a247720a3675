#include "experiments/cli/output_directory.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

#include "libsim/base/error.hpp"
#include "libsim/records/signal_file.hpp"

namespace modcal {

OutputDirectory::OutputDirectory(std::filesystem::path path) : path_(std::move(path)) {
  std::error_code error;
  std::filesystem::create_directories(path_, error);
  MODCAL_REQUIRE(!error && std::filesystem::is_directory(path_),
                 "the output folder {} cannot be made: {}; choose another one with --out",
                 path_.string(), error ? error.message() : "a file stands there");
  const std::filesystem::path probe = path_ / ".modcal-write-test";
  std::ofstream stream(probe);
  stream << "probe" << std::flush;
  const bool good = stream.good();
  const std::string reason = std::strerror(errno);
  stream.close();
  std::filesystem::remove(probe, error);
  MODCAL_REQUIRE(good,
                 "the output folder {} cannot be written to: {}; choose another one with --out",
                 path_.string(), reason);
}

void OutputDirectory::write_text(std::string_view name, std::string_view content) const {
  replace_file(path_ / name, [&](const std::filesystem::path& temporary) {
    std::ofstream stream(temporary, std::ios::binary);
    stream.write(content.data(), static_cast<std::streamsize>(content.size()));
    stream.close();
    MODCAL_REQUIRE(stream.good(), "{} cannot be written: {}", (path_ / name).string(),
                   std::strerror(errno));
  });
}

}  // namespace modcal
