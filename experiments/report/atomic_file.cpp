#include "experiments/report/atomic_file.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>

#include "libsim/records/signal_file.hpp"
#include "libsim/base/error.hpp"

namespace modcal::report {

void write_file_atomically(const std::filesystem::path& file, std::string_view content) {
  replace_file(file, [&](const std::filesystem::path& temporary) {
    errno = 0;
    std::ofstream stream(temporary, std::ios::binary);
    stream.write(content.data(), static_cast<std::streamsize>(content.size()));
    stream.close();
    MODCAL_REQUIRE(stream.good(), "{} cannot be written: {}", file.string(), std::strerror(errno));
  });
}

}  // namespace modcal::report
