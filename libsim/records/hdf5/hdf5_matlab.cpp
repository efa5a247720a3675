#include "libsim/records/hdf5/hdf5_matlab.hpp"

#include "libsim/base/words.hpp"
#include "libsim/records/hdf5/hdf5_content.hpp"
#include "libsim/records/hdf5/hdf5_texts.hpp"

namespace modcal {

std::string matlab_class(hid_t object) {
  constexpr const char* kClass = "MATLAB_class";
  if (H5Aexists(object, kClass) <= 0) return {};
  const Hdf5Id attribute(H5Aopen(object, kClass, H5P_DEFAULT), H5Aclose);
  if (!attribute.good()) return {};
  const Hdf5Id type(H5Aget_type(attribute.get()), H5Tclose);
  const Hdf5Id space(H5Aget_space(attribute.get()), H5Sclose);
  const bool is_text =
      H5Tget_class(type.get()) == H5T_STRING && H5Sget_simple_extent_npoints(space.get()) == 1;
  if (!is_text) return {};
  const std::vector<std::string> texts =
      texts_of(type.get(), 1, [&](hid_t as, void* to) { return H5Aread(attribute.get(), as, to); });
  return texts.empty() ? std::string() : texts.front();
}

bool is_matlab_empty(hid_t object) { return H5Aexists(object, "MATLAB_empty") > 0; }

std::vector<std::string> matlab_letters(hid_t dataset, std::size_t rows) {
  constexpr hssize_t kMost = 1 << 20;
  const Hdf5Id space(H5Dget_space(dataset), H5Sclose);
  const hssize_t size = H5Sget_simple_extent_npoints(space.get());
  if (size <= 0 || size > kMost) return {};
  std::vector<std::uint16_t> letters(static_cast<std::size_t>(size));
  if (H5Dread(dataset, H5T_NATIVE_UINT16, H5S_ALL, H5S_ALL, H5P_DEFAULT, letters.data()) < 0) {
    return {};
  }
  std::vector<std::string> texts;
  for (std::size_t row = 0; row < rows; ++row) {
    std::string text;
    for (std::size_t i = row; i < letters.size(); i += rows) append_utf8(letters[i], text);
    texts.emplace_back(trimmed(text));
  }
  return texts;
}

}  // namespace modcal
