#include "libsim/records/numpy/npy_arrays.hpp"

#include <bit>
#include <cmath>
#include <cstring>

#include "libsim/base/error.hpp"
#include "libsim/base/utf8.hpp"
#include "libsim/records/csv_grammar.hpp"

namespace modcal {
namespace {

template <typename Number>
double number_of(const char* bytes) {
  Number number;
  std::memcpy(&number, bytes, sizeof number);
  return static_cast<double>(number);
}

// IEEE 754 binary16.
double half_of(const char* bytes) {
  std::uint16_t bits = 0;
  std::memcpy(&bits, bytes, sizeof bits);
  const int exponent = bits >> 10 & 31, fraction = bits & 1023;
  const double size = exponent == 31  ? (fraction == 0 ? INFINITY : NAN)
                      : exponent == 0 ? std::ldexp(fraction, -24)
                                      : std::ldexp(1024 + fraction, exponent - 25);
  return (bits & 0x8000) != 0 ? -size : size;
}

using NumberOf = double (*)(const char*);

// Null: no real number of a type that is read.
NumberOf number_of_type(const NpyType& type) {
  struct Known {
    char kind;
    std::size_t size;
    NumberOf read;
  };
  static constexpr std::array<Known, 12> kKnown = {{{'f', 2, half_of},
                                                    {'f', 4, number_of<float>},
                                                    {'f', 8, number_of<double>},
                                                    {'i', 1, number_of<std::int8_t>},
                                                    {'i', 2, number_of<std::int16_t>},
                                                    {'i', 4, number_of<std::int32_t>},
                                                    {'i', 8, number_of<std::int64_t>},
                                                    {'u', 1, number_of<std::uint8_t>},
                                                    {'u', 2, number_of<std::uint16_t>},
                                                    {'u', 4, number_of<std::uint32_t>},
                                                    {'u', 8, number_of<std::uint64_t>},
                                                    {'b', 1, number_of<std::uint8_t>}}};
  for (const Known& known : kKnown) {
    if (known.kind == type.kind && known.size == type.size) return known.read;
  }
  return nullptr;
}

NamedArray::Holds holds(const NpyType& type) {
  const bool is_complex = type.kind == 'c' && (type.size == 8 || type.size == 16);
  if (is_complex) return NamedArray::Holds::kComplex;
  if (type.kind == 'U' || type.kind == 'S') return NamedArray::Holds::kText;
  return number_of_type(type) == nullptr ? NamedArray::Holds::kOther : NamedArray::Holds::kReal;
}

std::string text_at(const char* begin, const NpyType& type) {
  std::string result;
  if (type.kind == 'S') {
    result.assign(begin, type.size);
    return result.substr(0, result.find('\0'));
  }
  for (std::size_t i = 0; i + 4 <= type.size; i += 4) {
    std::uint32_t letter = 0;
    std::memcpy(&letter, begin + i, sizeof letter);
    if (type.is_swapped) letter = __builtin_bswap32(letter);
    if (letter == 0) break;
    const bool is_letter = letter < 0xd800 || (letter > 0xdfff && letter < 0x110000);
    append_utf8(is_letter ? letter : 0xfffd, result);
  }
  return result;
}

// Two dimensions; more stay as they are.
std::vector<std::size_t> table_of(std::vector<std::size_t> shape) {
  while (shape.size() < 2) shape.push_back(1);
  return shape;
}

}  // namespace

void NpyArrays::add(const std::vector<std::string>& name, const std::string& place,
                    std::uint64_t size, const std::function<NpyBytes()>& open) {
  const NpyHeader header = read_npy_header(open(), place);
  // Objects of Python are pickled, in any number of bytes.
  const bool has_objects = std::ranges::any_of(
      header.fields, [](const NpyField& field) { return field.type.kind == 'O'; });
  const std::uint64_t stated = header.data_begin + header.count(place) * header.item_size;
  MODCAL_REQUIRE(has_objects || stated <= size,
                 "{}: byte {}: {} bytes are announced, {} are there; it was cut off", place, size,
                 stated, size);
  MODCAL_REQUIRE(has_objects || stated == size, "{}: byte {}: {} bytes stand behind the array",
                 place, stated, size - stated);
  for (const NpyField& field : header.fields) {
    NamedArray array{.path = name, .dims = table_of(header.shape), .place = stored_.size()};
    array.holds = has_objects ? NamedArray::Holds::kOther : holds(field.type);
    array.is_single = field.type.kind == 'f' && field.type.size < 8;
    array.is_integer = field.type.kind == 'i' || field.type.kind == 'u';
    if (!field.name.empty()) {
      const ColumnHeading heading = parse_heading(utf8_or_latin1(field.name));
      array.path.push_back(heading.name);
      array.title = heading.name;
      array.unit = heading.unit;
    }
    arrays_.push_back(std::move(array));
    stored_.push_back({place, header, field, open});
  }
}

std::vector<double> NpyArrays::column(const NamedArray& array, std::size_t j) {
  const Stored& stored = stored_[array.place];
  const NpyHeader& header = stored.header;
  // A complex number is two floats.
  const std::size_t parts = stored.field.type.kind == 'c' ? 2 : 1;
  const std::size_t width = stored.field.type.size / parts;
  const NumberOf read = number_of_type(parts == 2 ? NpyType{'f', width} : stored.field.type);
  const std::size_t rows = array.rows(), item = header.item_size;
  // Places of the channel's samples among the items.
  const bool is_along = array.is_across() == header.is_fortran;
  const std::size_t step = is_along ? array.columns() : 1;
  const std::size_t first = is_along ? j : j * rows;
  const NpyBytes bytes = stored.open();
  std::vector<char> block(header.data_begin);
  bytes(block.data(), block.size());
  const std::size_t held = std::max<std::size_t>(1, (1 << 16) / item);
  block.resize(held * item);
  const std::size_t end = first + (rows - 1) * step + 1;
  std::vector<double> samples;
  samples.reserve(rows * parts);
  std::size_t wanted = first;
  for (std::size_t begin = 0; begin < end; begin += held) {
    const std::size_t count = std::min(held, end - begin);
    bytes(block.data(), count * item);
    for (; wanted < begin + count && samples.size() < rows * parts; wanted += step) {
      for (std::size_t part = 0; part < parts; ++part) {
        char* const at =
            block.data() + (wanted - begin) * item + stored.field.offset + part * width;
        if (stored.field.type.is_swapped) std::reverse(at, at + width);
        samples.push_back(read(at));
      }
    }
  }
  return samples;
}

std::vector<std::string> NpyArrays::texts(const NamedArray& array) {
  const Stored& stored = stored_[array.place];
  constexpr std::size_t kLongestText = 1 << 16, kMostTexts = 1 << 12;
  const std::size_t item = stored.header.item_size;
  if (array.size() > kMostTexts || item > kLongestText) return {};
  const NpyBytes bytes = stored.open();
  std::vector<char> block(stored.header.data_begin + array.size() * item);
  bytes(block.data(), block.size());
  const char* at = block.data() + stored.header.data_begin + stored.field.offset;
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < array.size(); ++i, at += item) {
    texts.push_back(text_at(at, stored.field.type));
  }
  return texts;
}

}  // namespace modcal
