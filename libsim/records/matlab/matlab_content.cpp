#include "libsim/records/matlab/matlab_content.hpp"

#include <hdf5.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>

#include "libsim/base/error.hpp"
#include "libsim/base/files.hpp"
#include "libsim/base/utf8.hpp"
#include "libsim/records/hdf5/hdf5_file.hpp"
#include "libsim/records/matlab/matlab_file.hpp"

namespace modcal {
namespace {

using Path = std::filesystem::path;
using Variable = std::unique_ptr<matvar_t, decltype(&Mat_VarFree)>;
using File = std::unique_ptr<mat_t, decltype(&Mat_Close)>;

Variable owned(matvar_t* variable) { return {variable, &Mat_VarFree}; }

// Numbers of 32 bits at a place of a file, in its order of bytes; zeros past its end.
template <std::size_t kCount>
std::array<std::uint32_t, kCount> words_at(std::ifstream& file, std::streamoff at,
                                           bool is_swapped) {
  std::array<std::uint32_t, kCount> words{};
  file.seekg(at);
  file.read(reinterpret_cast<char*>(words.data()), sizeof words);
  for (std::uint32_t& word : words) word = is_swapped ? __builtin_bswap32(word) : word;
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

// What a compressed variable of version 5 begins with: tags of itself, of its flags and of its
// dimensions. libmatio takes memory for as many dimensions as are stated, up to 2^30.
bool has_few_dimensions(std::ifstream& file, std::streamoff at, std::streamoff size,
                        bool is_swapped) {
  constexpr std::uint32_t kFlagBytes = 8, kDimensions = 5, kMostBytes = 4 * 64;
  std::array<unsigned char, 1024> packed{};
  const auto taken = std::min(std::ssize(packed), size);
  file.seekg(at);
  file.read(reinterpret_cast<char*>(packed.data()), taken);
  std::array<std::uint32_t, 8> words{};
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) return false;
  stream.next_in = packed.data();
  stream.avail_in = static_cast<uInt>(taken);
  stream.next_out = reinterpret_cast<unsigned char*>(words.data());
  stream.avail_out = sizeof words;
  inflate(&stream, Z_SYNC_FLUSH);
  inflateEnd(&stream);
  if (stream.avail_out > 0) return false;
  for (std::uint32_t& word : words) word = is_swapped ? __builtin_bswap32(word) : word;
  // Tables, texts and dates of MATLAB's own have none.
  return words[3] == kFlagBytes && (words[6] != kDimensions || words[7] <= kMostBytes);
}

// Whether all that is packed can be unpacked and has the checksum that stands behind it, which
// libmatio does not compare.
bool is_intact(std::ifstream& file, std::streamoff at, std::streamoff size) {
  std::vector<unsigned char> packed(1 << 16), numbers(1 << 16);
  z_stream stream{};
  if (inflateInit(&stream) != Z_OK) return false;
  int state = Z_OK;
  file.seekg(at);
  while (state == Z_OK) {
    if (stream.avail_in == 0) {
      const auto taken = std::min(std::ssize(packed), size);
      file.read(reinterpret_cast<char*>(packed.data()), taken);
      size -= taken;
      stream.next_in = packed.data();
      stream.avail_in = static_cast<uInt>(taken);
    }
    stream.next_out = numbers.data();
    stream.avail_out = static_cast<uInt>(numbers.size());
    state = inflate(&stream, Z_NO_FLUSH);
  }
  inflateEnd(&stream);
  return state == Z_STREAM_END;
}

// libmatio takes the end of a file that was cut off for the end of its variables, and asks for
// what a header states. Version 5: a header of 128 bytes, then variables, each with its size before
// it; version 4: variables alone; the others are those of HDF5. read: numbers are read, not headers
// alone.
void require_whole(const Path& path, bool read) {
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
    const std::array<std::uint32_t, 2> tag = words_at<2>(file, at, is_swapped);
    const double bytes = is_five ? static_cast<double>(kTag) + tag[1]
                                 : bytes_of_version_4(words_at<5>(file, at, is_swapped));
    if (at == 0 && std::isinf(bytes)) return;  // another file
    MODCAL_REQUIRE(file && bytes <= static_cast<double>(size - at),
                   "{}: the file is cut off: the variable at byte {} is not whole; copy or save "
                   "it again",
                   path.string(), at);
    constexpr std::uint32_t kCompressed = 15;
    MODCAL_REQUIRE(!is_five || tag[0] != kCompressed ||
                       (has_few_dimensions(file, at + kTag, tag[1], is_swapped) &&
                        (!read || is_intact(file, at + kTag, tag[1]))),
                   "{}: the compressed variable at byte {} is damaged; copy or save it again",
                   path.string(), at);
    file.clear();
    at += static_cast<std::streamoff>(bytes);
  }
}

File opened(const Path& path, bool read) {
  require_regular_file(path);
  MODCAL_REQUIRE(std::filesystem::exists(path), "{}: there is no such file; check the path",
                 path.string());
  MODCAL_REQUIRE(std::filesystem::file_size(path) > 0, "{}: the file is empty", path.string());
  require_whole(path, read);
  // What HDF5 says on the terminal is said by the refusal.
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  File file(Mat_Open(path.c_str(), MAT_ACC_RDONLY), &Mat_Close);
  MODCAL_REQUIRE(file != nullptr,
                 "{}: cannot be read as a MAT file; save it again (save -v7), or export it as CSV",
                 path.string());
  return file;
}

std::size_t size_of(const matvar_t& variable) {
  std::size_t size = 1;
  for (int i = 0; i < variable.rank; ++i) size *= variable.dims[i];
  return variable.rank > 0 ? size : 0;
}

template <typename Number>
double number_at(const void* numbers, std::size_t i) {
  return static_cast<double>(static_cast<const Number*>(numbers)[i]);
}

using NumberAt = double (*)(const void*, std::size_t);

// How a number of a class is read; null: it has no numbers.
NumberAt number_of_class(matio_classes type) {
  static const std::map<matio_classes, NumberAt> kClasses = {
      {MAT_C_DOUBLE, number_at<double>},      {MAT_C_SINGLE, number_at<float>},
      {MAT_C_INT8, number_at<std::int8_t>},   {MAT_C_UINT8, number_at<std::uint8_t>},
      {MAT_C_INT16, number_at<std::int16_t>}, {MAT_C_UINT16, number_at<std::uint16_t>},
      {MAT_C_INT32, number_at<std::int32_t>}, {MAT_C_UINT32, number_at<std::uint32_t>},
      {MAT_C_INT64, number_at<std::int64_t>}, {MAT_C_UINT64, number_at<std::uint64_t>}};
  const auto found = kClasses.find(type);
  return found == kClasses.end() ? nullptr : found->second;
}

}  // namespace

void MatlabContent::add_arrays(matvar_t* variable, std::vector<std::string> path, Leaf at) {
  using Holds = NamedArray::Holds;
  if (variable->class_type != MAT_C_STRUCT) {
    at.type = variable->class_type;
    const bool has_numbers = number_of_class(at.type) != nullptr;
    arrays_.push_back({.path = std::move(path),
                       .dims = {variable->dims, variable->dims + variable->rank},
                       .holds = has_numbers
                                    ? variable->isComplex != 0 ? Holds::kComplex : Holds::kReal
                                : at.type == MAT_C_CHAR ? Holds::kText
                                                        : Holds::kOther,
                       .is_single = at.type == MAT_C_SINGLE,
                       .place = leaves_.size()});
    leaves_.push_back(std::move(at));
    return;
  }
  if (size_of(*variable) != 1) return;
  char* const* const names = Mat_VarGetStructFieldnames(variable);
  for (std::size_t i = 0; i < Mat_VarGetNumberOfFields(variable); ++i) {
    matvar_t* const field = Mat_VarGetStructFieldByIndex(variable, i, 0);
    if (field == nullptr || names[i] == nullptr) continue;
    std::vector<std::string> below = path;
    below.emplace_back(names[i]);
    Leaf leaf = at;
    leaf.fields.push_back(i);
    add_arrays(field, std::move(below), std::move(leaf));
  }
}

MatlabContent::MatlabContent(Path path) : path_(std::move(path)) {
  {
    const std::lock_guard lock(hdf5_lock());
    const File file = opened(path_, false);
    for (;;) {
      const Variable variable = owned(Mat_VarReadNextInfo(file.get()));
      if (variable == nullptr) break;
      if (variable->name == nullptr) continue;  // nothing could ask for it
      add_arrays(variable.get(), {variable->name}, {});
    }
  }
  read_heads();
}

// Names and units as write_matlab() left them.
void MatlabContent::read_heads() {
  for (const NamedArray& head : arrays_) {
    if (head.path.size() != 3 || head.path[0] != kMatlabHeads ||
        head.holds != NamedArray::Holds::kText) {
      continue;
    }
    const auto found = std::ranges::find(arrays_, std::vector{head.path[1]}, &NamedArray::path);
    if (found == arrays_.end()) continue;
    (head.path[2] == "unit" ? found->unit : found->title) = text(head);
  }
}

std::vector<double> MatlabContent::column(const NamedArray& array, std::size_t j) {
  const matvar_t& field = this->field(array);
  const NumberAt read = number_of_class(field.class_type);
  // Numbers stand column by column.
  const std::size_t step = array.is_across() ? array.dims[0] : 1;
  const std::size_t first = array.is_across() ? j : j * array.dims[0];
  std::vector<const void*> parts = {field.data};
  if (!array.is_real()) {
    const auto& split = *static_cast<const mat_complex_split_t*>(field.data);
    parts = {split.Re, split.Im};
    MODCAL_REQUIRE(field.isComplex != 0 && split.Re != nullptr && split.Im != nullptr,
                   "{}: the variable {} cannot be read: the file is damaged; save it again",
                   path_.string(), array.text());
  }
  std::vector<double> samples;
  samples.reserve(array.rows() * parts.size());
  for (std::size_t i = 0; i < array.rows(); ++i) {
    for (const void* const part : parts) samples.push_back(read(part, first + i * step));
  }
  return samples;
}

std::string MatlabContent::text(const NamedArray& array) {
  const matvar_t& field = this->field(array);
  const auto* const letters = static_cast<const char*>(field.data);
  const bool is_bytes = field.data_type == MAT_T_UINT8 || field.data_type == MAT_T_INT8 ||
                        field.data_type == MAT_T_UTF8;
  if (!is_bytes) return {};
  return utf8_or_latin1({letters, std::min(size_of(field), field.nbytes)});
}

const matvar_t& MatlabContent::field(const NamedArray& array) {
  const std::lock_guard lock(hdf5_lock());
  const Leaf& leaf = leaves_[array.place];
  Variable& variable = read_.try_emplace(array.path[0], owned(nullptr)).first->second;
  if (variable == nullptr) {
    const File file = opened(path_, !is_intact_);
    is_intact_ = true;
    variable = owned(Mat_VarRead(file.get(), array.path[0].c_str()));
  }
  matvar_t* found = variable.get();
  for (const std::size_t place : leaf.fields) {
    if (found != nullptr) found = Mat_VarGetStructFieldByIndex(found, place, 0);
  }
  MODCAL_REQUIRE(found != nullptr && found->data != nullptr && size_of(*found) == array.size() &&
                     found->class_type == leaf.type,
                 "{}: the variable {} cannot be read: the file is damaged; save it again",
                 path_.string(), array.text());
  return *found;
}

}  // namespace modcal
