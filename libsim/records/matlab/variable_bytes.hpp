// The bytes of a variable of a MAT file, one after the other.
#pragma once

#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <vector>

namespace modcal {

/// Thrown where a variable is damaged; the caller knows where it stands.
struct Damaged {};

inline void require_sound(bool holds) {
  if (!holds) throw Damaged{};
}

/// The bytes of one variable of version 5, as they stand in the file or packed in it.
class VariableBytes {
 public:
  VariableBytes(std::ifstream& file, std::streamoff at, std::streamoff size, bool is_packed)
      : file_(file), left_(size), is_packed_(is_packed) {
    file_.seekg(at);
    if (is_packed_) require_sound(inflateInit(&stream_) == Z_OK);
  }
  ~VariableBytes() {
    if (is_packed_) inflateEnd(&stream_);
  }
  VariableBytes(const VariableBytes&) = delete;
  VariableBytes& operator=(const VariableBytes&) = delete;

  /// Throws Damaged where there are fewer, as skip() does.
  void take(unsigned char* bytes, std::size_t count) {
    if (!is_packed_) {
      require_sound(
          static_cast<std::streamoff>(count) <= left_ &&
          file_.read(reinterpret_cast<char*>(bytes), static_cast<std::streamsize>(count)));
      left_ -= static_cast<std::streamoff>(count);
      return;
    }
    stream_.next_out = bytes;
    stream_.avail_out = static_cast<uInt>(count);
    while (stream_.avail_out > 0) require_sound(inflate_more() == Z_OK || stream_.avail_out == 0);
  }

  void skip(std::size_t count) {
    if (!is_packed_) {
      require_sound(static_cast<std::streamoff>(count) <= left_);
      file_.seekg(static_cast<std::streamoff>(count), std::ios::cur);
      left_ -= static_cast<std::streamoff>(count);
      return;
    }
    if (scratch_.empty()) scratch_.resize(kChunk);
    while (count > 0) {
      const std::size_t part = std::min(count, scratch_.size());
      take(scratch_.data(), part);
      count -= part;
    }
  }

  /// The rest, which for what is packed ends with its checksum.
  void end() {
    if (!is_packed_) return;
    if (scratch_.empty()) scratch_.resize(kChunk);
    do {
      stream_.next_out = scratch_.data();
      stream_.avail_out = static_cast<uInt>(scratch_.size());
    } while (inflate_more() == Z_OK);
    require_sound(state_ == Z_STREAM_END);
  }

 private:
  static constexpr std::size_t kChunk = 1 << 16;

  int inflate_more() {
    if (state_ != Z_OK) return state_;
    if (stream_.avail_in == 0) {
      if (packed_.empty()) packed_.resize(kChunk);
      const std::streamoff taken = std::min<std::streamoff>(std::ssize(packed_), left_);
      file_.read(reinterpret_cast<char*>(packed_.data()), taken);
      left_ -= taken;
      stream_.next_in = packed_.data();
      stream_.avail_in = static_cast<uInt>(taken);
    }
    return state_ = inflate(&stream_, Z_NO_FLUSH);
  }

  std::ifstream& file_;
  std::streamoff left_;
  bool is_packed_;
  z_stream stream_{};
  int state_ = Z_OK;
  std::vector<unsigned char> packed_, scratch_;
};

}  // namespace modcal
