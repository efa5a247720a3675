#include "libsim/records/universal/line_file.hpp"

#include "libsim/base/error.hpp"
#include "libsim/base/files.hpp"

namespace modcal {

LineFile::LineFile(const std::filesystem::path& path) : name_(path.string()) {
  require_regular_file(path);
  file_.open(path, std::ios::binary);
  MODCAL_REQUIRE(file_.is_open(), "{}: cannot be opened; check the path and its permissions",
                 name_);
  size_ = std::filesystem::file_size(path);
  MODCAL_REQUIRE(size_ > 0, "{}: the file is empty", name_);
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  std::string begin(kByteOrderMark.size(), '\0');
  file_.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  go_to({begin == kByteOrderMark ? begin.size() : 0, place_.line});
}

bool LineFile::next(std::string& line) {
  if (left() == 0 || !std::getline(file_, line)) return false;
  const bool ended = !file_.eof();
  place_.byte += line.size() + (ended ? 1 : 0);
  ++place_.line;
  if (line.ends_with('\r')) line.pop_back();
  return true;
}

void LineFile::require_left(std::uint64_t size) const {
  MODCAL_REQUIRE(size <= left(), "{}: byte {}: {} bytes are announced, {} are left; it was cut off",
                 name_, place_.byte, size, left());
}

std::string LineFile::bytes(std::uint64_t size) {
  require_left(size);
  std::string block(size, '\0');
  file_.read(block.data(), static_cast<std::streamsize>(size));
  MODCAL_REQUIRE(file_.gcount() == static_cast<std::streamsize>(size),
                 "{}: byte {}: reading failed", name_, place_.byte);
  place_.byte += size;
  return block;
}

void LineFile::skip(std::uint64_t size) {
  require_left(size);
  go_to({place_.byte + size, place_.line});
}

void LineFile::go_to(FilePlace place) {
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(place.byte));
  place_ = place;
}

}  // namespace modcal
