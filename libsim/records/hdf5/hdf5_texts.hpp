// Texts of HDF5 files, of a stated length each or of any.
#pragma once

#include <hdf5.h>

#include <cstring>
#include <string>
#include <vector>

#include "libsim/base/utf8.hpp"

namespace modcal {

/// The `count` texts that read(type, memory) reads; none where it fails.
template <typename Read>
std::vector<std::string> texts_of(hid_t type, std::size_t count, const Read& read) {
  constexpr std::size_t kLongest = 1 << 16;
  std::vector<std::string> texts;
  if (H5Tis_variable_str(type) > 0) {
    std::vector<char*> all(count, nullptr);
    if (read(type, static_cast<void*>(all.data())) < 0) return {};
    for (char* const letters : all) {
      texts.push_back(letters == nullptr ? "" : std::string(letters, strnlen(letters, kLongest)));
      H5free_memory(letters);
    }
  } else {
    const std::size_t size = H5Tget_size(type);
    if (size == 0 || size > kLongest || count > (std::size_t{1} << 24) / size) return {};
    std::string letters(count * size, '\0');
    if (read(type, static_cast<void*>(letters.data())) < 0) return {};
    for (std::size_t i = 0; i < count; ++i) {
      const std::string text = letters.substr(i * size, size);
      texts.push_back(text.substr(0, text.find('\0')));
    }
  }
  for (std::string& text : texts) text = utf8_or_latin1(text);
  return texts;
}

}  // namespace modcal
