#include "libsim/records/numpy/npy_header.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <optional>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
// numpy.lib.format refuses longer ones by itself; one of 4096 channels is shorter.
constexpr std::uint32_t kLongestHeader = 1 << 20;
constexpr std::size_t kMostNested = 1 << 3;

// The dictionary of Python that the header is.
class Literal {
 public:
  Literal(std::string text, const std::string& place, std::size_t begin)
      : text_(std::move(text)), place_(place), begin_(begin) {}

  NpyHeader read() {
    NpyHeader header;
    bool has_type = false, has_order = false, has_shape = false;
    expect('{');
    while (!take('}')) {
      const std::string key = string();
      expect(':');
      if (key == "descr") {
        header.item_size = type(header.fields, {}, 0);
        has_type = true;
      } else if (key == "fortran_order") {
        header.is_fortran = boolean();
        has_order = true;
      } else if (key == "shape") {
        header.shape = shape();
        has_shape = true;
      } else {
        fail(fmt::format("the key \"{}\" is none of an array", key));
      }
      if (!take(',')) {
        expect('}');
        break;
      }
    }
    if (!has_type || !has_order || !has_shape) fail("descr, fortran_order or shape is not there");
    return header;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw_invalid_input("{}: byte {}: the header of a NumPy array is damaged: {}", place_,
                        begin_ + at_, what);
  }
  void skip_blanks() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n')) ++at_;
  }
  bool take(char letter) {
    skip_blanks();
    if (at_ >= text_.size() || text_[at_] != letter) return false;
    ++at_;
    return true;
  }
  void expect(char letter) {
    if (!take(letter)) fail(fmt::format("'{}' is expected", letter));
  }
  std::string string() {
    skip_blanks();
    const char quote = at_ < text_.size() ? text_[at_] : '\0';
    if (quote != '\'' && quote != '"') fail("a text is expected");
    std::string result;
    for (++at_; at_ < text_.size() && text_[at_] != quote; ++at_) {
      if (text_[at_] == '\\' && at_ + 1 < text_.size()) ++at_;
      result += text_[at_];
    }
    if (at_ >= text_.size()) fail("a text has no end");
    ++at_;
    return result;
  }
  bool boolean() {
    skip_blanks();
    for (const bool value : {true, false}) {
      const std::string_view word = value ? "True" : "False";
      if (!std::string_view(text_).substr(at_).starts_with(word)) continue;
      at_ += word.size();
      return value;
    }
    fail("True or False is expected");
  }
  std::size_t whole() {
    skip_blanks();
    std::size_t value = 0;
    const auto [end, error] =
        std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (error != std::errc()) fail("a number is expected");
    at_ = static_cast<std::size_t>(end - text_.data());
    take('L');  // of Python 2
    return value;
  }
  std::vector<std::size_t> shape() {
    std::vector<std::size_t> result;
    expect('(');
    while (!take(')')) {
      result.push_back(whole());
      if (!take(',')) {
        expect(')');
        break;
      }
    }
    return result;
  }

  NpyType plain(std::string_view code) const {
    constexpr bool kLittle = std::endian::native == std::endian::little;
    NpyType result;
    char order = '=';
    if (!code.empty() && std::string_view("<>|=").find(code[0]) != std::string_view::npos) {
      order = code[0];
      code.remove_prefix(1);
    }
    result.is_swapped = order == (kLittle ? '>' : '<');
    if (code.empty()) fail("a type is empty");
    result.kind = code[0];
    code.remove_prefix(1);
    if (result.kind == 'O') {
      result.size = 8;
      return result;
    }
    const auto [end, error] = std::from_chars(code.data(), code.data() + code.size(), result.size);
    const bool has_unit = end != code.data() + code.size() && *end == '[';  // of an instant
    if (error != std::errc() || (end != code.data() + code.size() && !has_unit)) {
      fail("a type has no size");
    }
    if (result.kind == 'U') result.size *= 4;
    if (has_unit || std::string_view("fiubcUS").find(result.kind) == std::string_view::npos) {
      result.kind = 'V';
    }
    if (result.size > (std::size_t{1} << 32)) fail("a type is too large");
    return result;
  }

  // Fields of a type, with their places; its size.
  std::size_t type(std::vector<NpyField>& fields, const std::string& name, std::size_t offset) {
    if (!take('[')) {
      const NpyType one = plain(string());
      fields.push_back({name, one, offset});
      return one.size;
    }
    if (++nested_ > kMostNested) fail("its fields are nested too deeply");
    std::size_t size = 0;
    while (!take(']')) {
      expect('(');
      std::string own;
      if (take('(')) {  // title and name
        string();
        expect(',');
        own = string();
        expect(')');
      } else {
        own = string();
      }
      expect(',');
      const std::size_t first = fields.size();
      const std::string full = name.empty() ? own : fmt::format("{}.{}", name, own);
      const std::size_t one = type(fields, full, offset + size);
      std::size_t times = 1;
      if (take(',')) {
        for (const std::size_t n : shape()) {
          if (n > 4096 || times * n > 4096) fail("a field has more than 4096 values");
          times *= n;
        }
        repeat(fields, first, times, one);
      }
      size += one * times;
      expect(')');
      if (fields.size() > kLongestHeader) fail("there are too many fields");
      if (!take(',')) {
        expect(']');
        break;
      }
    }
    --nested_;
    return size;
  }
  static void repeat(std::vector<NpyField>& fields, std::size_t first, std::size_t times,
                     std::size_t size) {
    const std::vector<NpyField> once(fields.begin() + static_cast<std::ptrdiff_t>(first),
                                     fields.end());
    fields.resize(first);
    for (std::size_t i = 0; i < times; ++i) {
      for (NpyField field : once) {
        field.name += fmt::format("_{}", i + 1);
        field.offset += i * size;
        fields.push_back(std::move(field));
      }
    }
  }

  std::string text_;
  const std::string& place_;
  std::size_t begin_ = 0, at_ = 0, nested_ = 0;
};

}  // namespace

std::uint64_t NpyHeader::count(const std::string& place) const {
  std::uint64_t result = 1, bytes = item_size;
  for (const std::size_t n : shape) {
    const bool fits = !__builtin_mul_overflow(result, n, &result) &&
                      !__builtin_mul_overflow(result, item_size, &bytes) && bytes < (1ull << 62);
    MODCAL_REQUIRE(fits, "{}: its shape states more than any file holds: the header is damaged",
                   place);
  }
  return result;
}

NpyHeader read_npy_header(const NpyBytes& bytes, const std::string& place) {
  std::array<char, 8> begin{};
  bytes(begin.data(), begin.size());
  MODCAL_REQUIRE(std::string_view(begin.data(), kMagic.size()) == kMagic,
                 "{}: byte 0: this is no NumPy array; state another format, or save it again with "
                 "numpy.save",
                 place);
  MODCAL_REQUIRE(begin[6] >= 1 && begin[6] <= 3, "{}: byte 6: version {} of the format is not read",
                 place, static_cast<int>(begin[6]));
  const std::size_t wide = begin[6] == 1 ? 2 : 4;
  std::array<unsigned char, 4> length{};
  bytes(reinterpret_cast<char*>(length.data()), wide);
  std::uint32_t size = 0;
  for (std::size_t i = wide; i-- > 0;) size = size << 8 | length[i];
  MODCAL_REQUIRE(size <= kLongestHeader, "{}: byte 8: a header of {} bytes is announced", place,
                 size);
  std::string text(size, '\0');
  bytes(text.data(), size);
  NpyHeader header = Literal(std::move(text), place, 8 + wide).read();
  header.data_begin = 8 + wide + size;
  header.count(place);
  return header;
}

std::string npy_header_text(const std::string& type, std::string_view shape) {
  std::string text =
      fmt::format("{{'descr': {}, 'fortran_order': False, 'shape': {}, }}", type, shape);
  // The data begin at a whole 64 bytes.
  const auto padded = [&text](std::size_t before) {
    return (before + text.size() + 1 + 63) / 64 * 64 - before;
  };
  // Names that are not ASCII take version 3.
  const bool is_ascii = std::ranges::all_of(
      text, [](char letter) { return static_cast<unsigned char>(letter) < 128; });
  const char version = !is_ascii ? '\3' : padded(10) < 65536 ? '\1' : '\2';
  const std::size_t before = version == '\1' ? 10 : 12, size = padded(before);
  text.resize(size - 1, ' ');
  text += '\n';
  std::string result(kMagic);
  result += {version, '\0'};
  for (std::size_t i = 0; i < before - 8; ++i) {
    result += static_cast<char>(size >> (8 * i) & 0xff);
  }
  return result + text;
}

}  // namespace modcal
