#include "libsim/records/hdf5/hdf5_complex.hpp"

#include <string>

namespace modcal {
namespace {

std::string member_name(hid_t type, unsigned part) {
  char* const name = H5Tget_member_name(type, part);
  std::string text = name == nullptr ? "" : name;
  H5free_memory(name);
  return text;
}

}  // namespace

bool is_complex(hid_t type) {
  if (H5Tget_class(type) != H5T_COMPOUND || H5Tget_nmembers(type) != 2) return false;
  if (H5Tget_member_class(type, 0) != H5T_FLOAT || H5Tget_member_class(type, 1) != H5T_FLOAT) {
    return false;
  }
  const std::string names = member_name(type, 0) + ' ' + member_name(type, 1);
  return names == "r i" || names == "re im" || names == "real imag" || names == "real imaginary";
}

Hdf5Id complex_in_memory(hid_t stored) {
  Hdf5Id type(H5Tcreate(H5T_COMPOUND, 2 * sizeof(double)), H5Tclose);
  for (unsigned part = 0; part < 2; ++part) {
    H5Tinsert(type.get(), member_name(stored, part).c_str(), part * sizeof(double),
              H5T_NATIVE_DOUBLE);
  }
  return type;
}

}  // namespace modcal
