#include "libsim/records/matlab/matlab_layout.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <limits>
#include <string_view>
#include <utility>

#include "libsim/base/error.hpp"
#include "libsim/records/matlab/variable_bytes.hpp"

namespace modcal {
namespace {

std::uint32_t in_order(std::uint32_t word, bool is_swapped) {
  return is_swapped ? __builtin_bswap32(word) : word;
}

// Numbers of 32 bits at a place of a file; zeros past its end.
template <std::size_t kCount>
std::array<std::uint32_t, kCount> words_at(std::ifstream& file, std::streamoff at,
                                           bool is_swapped) {
  std::array<std::uint32_t, kCount> words{};
  file.seekg(at);
  file.read(reinterpret_cast<char*>(words.data()), sizeof words);
  file.clear();
  for (std::uint32_t& word : words) word = in_order(word, is_swapped);
  return words;
}

// Bytes of a variable of version 4 with its header: a type of the digits MOPT, rows, columns,
// whether there are imaginary parts, letters of the name. Infinite where there is no such type.
double bytes_of_version_4(const std::array<std::uint32_t, 5>& header) {
  constexpr std::array kBytes = {8.0, 4.0, 4.0, 2.0, 2.0, 1.0};
  const std::size_t precision = header[0] / 10 % 10;
  if (header[0] >= 5000 || precision >= kBytes.size()) {
    return std::numeric_limits<double>::infinity();
  }
  const double parts = header[3] != 0 && header[0] % 10 != 2 ? 2.0 : 1.0;  // 2: sparse
  return 20.0 + header[4] + parts * kBytes[precision] * header[1] * header[2];
}

// Walks through one variable by the sizes that it states.
class VariableWalk {
 public:
  VariableWalk(VariableBytes& bytes, bool is_swapped) : bytes_(bytes), is_swapped_(is_swapped) {}

  // What follows the tag of a matrix: flags, dimensions, a name and what its class holds.
  void matrix(std::size_t size, std::uint32_t depth = 0) {
    if (size == 0) return;
    constexpr std::uint32_t kDeepest = 64;
    require_sound(depth < kDeepest);
    const std::size_t outer = std::exchange(left_, size);
    const Element flags = element();
    require_sound(flags.size == 8);
    const std::uint32_t flag_word = word();
    const auto type = static_cast<Class>(flag_word & 0xff);
    drop(4);
    contents(type, (flag_word & 0x800) != 0, depth);
    drop(left_);
    left_ = outer - size;
  }

 private:
  enum Class : std::uint8_t {
    kCell = 1,
    kStructure = 2,
    kObject = 3,
    kText = 4,
    kSparse = 5,
    kDouble = 6,
    kUnsigned64 = 15,
    kFunction = 16,
    kOpaque = 17  ///< tables and dates of MATLAB's own
  };
  enum Type : std::uint8_t { kMatrix = 14 };
  struct Element {
    std::uint32_t type, size;
    bool is_small;
  };

  void contents(Class type, bool is_complex, std::uint32_t depth) {
    require_sound(type >= kCell && type <= kOpaque);
    const double count = type == kOpaque ? 0.0 : dimensions();
    pass(element());              // its name
    if (type == kOpaque) return;  // nothing that libmatio reads
    if (type == kSparse) {        // indices of rows and columns, numbers
      while (left_ > 0) pass(element());
      return;
    }
    if ((type >= kDouble && type <= kUnsigned64) || type == kText) {
      numbers(count);
      if (is_complex) numbers(count);
      return;
    }
    double fields = 1.0;
    if (type == kObject) pass(element());  // the name of its class
    if (type != kCell && type != kFunction) {
      const Element length = element();
      require_sound(length.size == 4);
      const std::uint32_t letters = word();
      if (!length.is_small) drop(4);
      const Element names = element();
      fields = letters > 0 ? names.size / letters : 0;
      pass(names);
    }
    // Each has a tag of 8 bytes.
    require_sound(8.0 * count * fields <= static_cast<double>(left_));
    for (auto i = static_cast<std::size_t>(count * fields); i > 0; --i) {
      const Element inner = element();
      require_sound(inner.type == kMatrix && inner.size <= left_);
      matrix(inner.size, depth + 1);
    }
  }

  double dimensions() {
    constexpr std::uint32_t kSigned = 5, kUnsigned = 6, kFewestBytes = 8, kMostBytes = 4 * 64;
    const Element stated = element();
    require_sound(stated.type == kSigned || stated.type == kUnsigned);
    require_sound(stated.size >= kFewestBytes && stated.size <= kMostBytes);
    double count = 1.0;
    for (std::uint32_t i = 0; i < stated.size / 4; ++i) count *= word();
    drop(stated.size % 8);  // to a multiple of 8: of an odd number of dimensions
    return count;
  }

  // As many numbers of any width as the dimensions state.
  void numbers(double count) {
    if (left_ == 0 && count == 0) return;
    static constexpr std::array<std::uint8_t, 19> kBytes = {0, 1, 1, 2, 2, 4, 4, 4, 0, 8,
                                                            0, 0, 8, 8, 0, 0, 1, 2, 4};
    const Element held = element();
    const std::uint32_t width = held.type < kBytes.size() ? kBytes[held.type] : 0;
    // Some programs write an empty text as one letter without its bytes.
    require_sound(width > 0 && (count * width <= held.size || (count == 1 && held.size == 0)));
    pass(held);
  }

  // A tag; up to four bytes may stand in it in place of behind it.
  Element element() {
    const std::uint32_t first = word();
    if (first >> 16 != 0) return {first & 0xffff, first >> 16, true};
    return {first, word(), false};
  }

  void pass(const Element& held) {
    if (held.is_small) {
      require_sound(held.size <= 4);
      drop(4);
      return;
    }
    // What follows begins at a multiple of eight bytes.
    drop(held.size);
    drop(std::min<std::size_t>((8 - held.size % 8) % 8, left_));
  }

  std::uint32_t word() {
    std::uint32_t value = 0;
    require_sound(left_ >= sizeof value);
    bytes_.take(reinterpret_cast<unsigned char*>(&value), sizeof value);
    left_ -= sizeof value;
    return in_order(value, is_swapped_);
  }

  void drop(std::size_t count) {
    require_sound(count <= left_);
    bytes_.skip(count);
    left_ -= count;
  }

  VariableBytes& bytes_;
  bool is_swapped_;
  std::size_t left_ = std::numeric_limits<std::size_t>::max();  ///< of the innermost matrix
};

bool is_sound(std::ifstream& file, std::streamoff at, std::array<std::uint32_t, 2> tag,
              bool is_swapped) {
  constexpr std::uint32_t kMatrix = 14, kPacked = 15;
  if (tag[0] != kMatrix && tag[0] != kPacked) return true;
  try {
    VariableBytes bytes(file, at, tag[1], tag[0] == kPacked);
    std::size_t size = tag[1];
    if (tag[0] == kPacked) {
      std::array<std::uint32_t, 2> inner{};
      bytes.take(reinterpret_cast<unsigned char*>(inner.data()), sizeof inner);
      if (in_order(inner[0], is_swapped) == kMatrix) size = in_order(inner[1], is_swapped);
    }
    VariableWalk(bytes, is_swapped).matrix(size);
    bytes.end();
    return true;
  } catch (const Damaged&) {
    file.clear();
    return false;
  }
}

}  // namespace

void require_whole_matlab_file(const std::filesystem::path& path) {
  constexpr std::streamoff kHeader = 128, kVersion = 124, kOrder = 126, kTag = 8;
  std::ifstream file(path, std::ios::binary);
  std::array<char, kHeader> header{};
  const auto size = static_cast<std::streamoff>(std::filesystem::file_size(path));
  file.read(header.data(), kHeader);
  file.clear();
  const std::string_view begin(header.data(), 10), order(header.data() + kVersion, 4);
  // As libmatio knows it: 0x0100 and "MI", in the order of bytes of the file.
  const bool is_five = size >= kHeader && (order == std::string_view("\0\1IM", 4) ||
                                           order == std::string_view("\1\0MI", 4));
  if (!is_five && (begin.starts_with("MATLAB") || begin.starts_with("\x89HDF"))) return;
  const bool is_swapped =
      is_five ? (header[kOrder] == 'I') != (std::endian::native == std::endian::little)
              : words_at<1>(file, 0, false)[0] >= 5000;
  for (std::streamoff at = is_five ? kHeader : 0; at < size;) {
    const auto tag = words_at<2>(file, at, is_swapped);
    const double bytes = is_five ? static_cast<double>(kTag) + tag[1]
                                 : bytes_of_version_4(words_at<5>(file, at, is_swapped));
    if (at == 0 && std::isinf(bytes)) return;  // another file
    MODCAL_REQUIRE(bytes <= static_cast<double>(size - at),
                   "{}: the file is cut off: the variable at byte {} is not whole; copy or save "
                   "it again",
                   path.string(), at);
    MODCAL_REQUIRE(!is_five || is_sound(file, at + kTag, tag, is_swapped),
                   "{}: the variable at byte {} is damaged; copy or save it again", path.string(),
                   at);
    at += static_cast<std::streamoff>(bytes);
  }
}

}  // namespace modcal
