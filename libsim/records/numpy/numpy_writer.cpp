#include <zip.h>

#include <bit>
#include <fstream>
#include <list>

#include "libsim/base/error.hpp"
#include "libsim/base/utf8.hpp"
#include "libsim/records/arrays/array_file.hpp"
#include "libsim/records/csv_grammar.hpp"
#include "libsim/records/numpy/npy_header.hpp"
#include "libsim/records/numpy/numpy_file.hpp"
#include "libsim/records/signal_file.hpp"

namespace modcal {
namespace {

using Path = std::filesystem::path;

constexpr std::string_view kDouble = std::endian::native == std::endian::little ? "<f8" : ">f8";

// A text of Python.
std::string python_text(std::string_view text) {
  std::string result = "'";
  for (const char letter : text) {
    if (letter == '\'' || letter == '\\') result += '\\';
    result += letter;
  }
  return result + "'";
}

void require_plain_name(const std::string& name, const std::string& unit, const std::string& file) {
  MODCAL_REQUIRE(
      std::ranges::none_of(name + unit,
                           [](char letter) { return static_cast<unsigned char>(letter) < ' '; }),
      "{}: the name of channel {} has a control character; rename it", file, name);
}

// What a member of the archive is made of; its parts must outlive it.
class NumpyWriter {
 public:
  explicit NumpyWriter(const std::string& name) : name_(name) {
    zip_error_init(&error_);
    target_ = zip_source_buffer_create(nullptr, 0, 0, &error_);
    if (target_ == nullptr) throw std::bad_alloc();
    zip_source_keep(target_);
    zip_ = zip_open_from_source(target_, ZIP_CREATE | ZIP_TRUNCATE, &error_);
    if (zip_ == nullptr) throw std::bad_alloc();
  }
  ~NumpyWriter() {
    if (zip_ != nullptr) zip_discard(zip_);
    zip_source_free(target_);
    zip_error_fini(&error_);
  }
  NumpyWriter(const NumpyWriter&) = delete;
  NumpyWriter& operator=(const NumpyWriter&) = delete;

  void add(const std::string& member, std::string header, std::span<const char> data) {
    const std::string& kept = headers_.emplace_back(std::move(header));
    const zip_buffer_fragment_t parts[] = {
        {reinterpret_cast<zip_uint8_t*>(const_cast<char*>(kept.data())), kept.size()},
        {reinterpret_cast<zip_uint8_t*>(const_cast<char*>(data.data())), data.size()}};
    zip_source_t* const source = zip_source_buffer_fragment(zip_, parts, data.empty() ? 1 : 2, 0);
    const zip_int64_t index =
        source == nullptr ? -1
                          : zip_file_add(zip_, (member + ".npy").c_str(), source, ZIP_FL_ENC_UTF_8);
    MODCAL_REQUIRE(index >= 0, "{}: the channel {} cannot be written: {}", name_, member,
                   zip_strerror(zip_));
    const auto place = static_cast<zip_uint64_t>(index);
    // Stored as it is, and on the day that NumPy writes, so that equal records are equal files.
    constexpr zip_uint16_t kDay = 1 << 5 | 1;
    zip_set_file_compression(zip_, place, ZIP_CM_STORE, 0);
    zip_file_set_dostime(zip_, place, 0, kDay, 0);
  }
  void write_to(const Path& path) {
    MODCAL_REQUIRE(zip_close(zip_) == 0, "{}: writing failed: {}", name_, zip_strerror(zip_));
    zip_ = nullptr;
    std::ofstream file(path, std::ios::binary);
    std::vector<char> block(1 << 20);
    MODCAL_REQUIRE(zip_source_open(target_) == 0, "{}: writing failed", name_);
    for (;;) {
      const zip_int64_t size = zip_source_read(target_, block.data(), block.size());
      if (size <= 0) break;
      file.write(block.data(), size);
    }
    zip_source_close(target_);
    file.close();
    MODCAL_REQUIRE(!file.fail(), "{}: writing failed; is the disk full?", name_);
  }

 private:
  const std::string& name_;
  zip_error_t error_{};
  zip_source_t* target_ = nullptr;
  zip_t* zip_ = nullptr;
  std::list<std::string> headers_;
};

// A text as NumPy keeps it, four bytes a letter.
std::string text_array(const std::string& text) {
  const std::string utf8 = utf8_or_latin1(text);
  std::string letters;
  for (std::size_t at = 0; at < utf8.size();) {
    const std::size_t size = std::max<std::size_t>(1, utf8_size(std::string_view(utf8).substr(at)));
    std::uint32_t letter = static_cast<unsigned char>(utf8[at]) & (size == 1 ? 0x7f : 0xff >> size);
    for (std::size_t i = 1; i < size; ++i) {
      letter = letter << 6 | (static_cast<unsigned char>(utf8[at + i]) & 0x3f);
    }
    letters.append(reinterpret_cast<const char*>(&letter), sizeof letter);
    at += size;
  }
  if (letters.empty()) letters.assign(4, '\0');
  return npy_header_text(fmt::format("'{}U{}'", kDouble[0], letters.size() / 4), "()") + letters;
}

std::span<const char> bytes_of(std::span<const double> numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()};
}

}  // namespace

void write_npy(const Path& path, std::span<const Signal> signals, const RecordNotes& notes) {
  const std::string name = path.string();
  require_one_record(signals, name);
  for (const Signal& signal : signals) {
    require_plain_name(signal.quantity, signal.unit, name);
    MODCAL_REQUIRE(!is_name_of_time(signal.quantity),
                   "{}: a field \"{}\" of an array would be taken for the instants; rename the "
                   "channel, or write another format",
                   name, signal.quantity);
  }
  const std::size_t size = signals.front().size();
  const double rate = signals.front().sample_rate;
  std::string fields = fmt::format("[({}, '{}')", python_text("t [s]"), kDouble);
  for (const Signal& signal : signals) {
    fields += fmt::format(", ({}, '{}')", python_text(heading_text(signal.quantity, signal.unit)),
                          kDouble);
  }
  replace_file(path, [&](const Path& temporary) {
    std::ofstream file(temporary, std::ios::binary);
    file << npy_header_text(fields + "]", fmt::format("({},)", size));
    std::vector<double> row(signals.size() + 1);
    for (std::size_t i = 0; i < size; ++i) {
      row[0] = notes.start + static_cast<double>(i) / rate;
      for (std::size_t k = 0; k < signals.size(); ++k) row[k + 1] = signals[k].samples[i];
      file.write(bytes_of(row).data(), static_cast<std::streamsize>(bytes_of(row).size()));
    }
    file.close();
    MODCAL_REQUIRE(!file.fail(), "{}: writing failed; is the disk full?", name);
  });
}

void write_npz(const Path& path, const WrittenArrays& arrays) {
  const std::string name = path.string();
  for (const WrittenArray& array : arrays.arrays) {
    require_plain_name(array.name, array.unit, name);
    MODCAL_REQUIRE(array.name != "provenance",
                   "{}: an array \"provenance\" of an NPZ file says where it is from; rename the "
                   "channel, or write another format",
                   name);
    MODCAL_REQUIRE(!arrays.is_for_axis(array.name),
                   "{}: an array \"{}\" of an NPZ file would be taken for the {}; rename the "
                   "channel, or write another format",
                   name, array.name, arrays.has_lines() ? "frequencies" : "sampling");
  }
  replace_file(path, [&](const Path& temporary) {
    NumpyWriter writer(name);
    const auto header = [](bool is_complex, const std::string& shape) {
      return npy_header_text(
          fmt::format("'{}{}'", kDouble[0], is_complex ? "c16" : kDouble.substr(1)), shape);
    };
    const auto vector_shape = [](std::size_t size) { return fmt::format("({},)", size); };
    writer.add(arrays.axis,
               header(false, arrays.has_lines() ? vector_shape(arrays.axis_values.size()) : "()"),
               bytes_of(arrays.axis_values));
    if (arrays.has_lines()) writer.add(arrays.axis + ".unit", text_array("Hz"), {});
    if (arrays.has_start()) writer.add(kStart, header(false, "()"), bytes_of({&arrays.start, 1}));
    for (const WrittenArray& array : arrays.arrays) {
      writer.add(array.name, header(array.is_complex, vector_shape(array.size())),
                 bytes_of(array.numbers));
      writer.add(array.name + ".unit", text_array(array.unit), {});
    }
    writer.add("provenance", text_array(arrays.provenance), {});
    writer.write_to(temporary);
  });
}

}  // namespace modcal
