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

Hdf5Id pair_of_doubles(const std::string& real, const std::string& imaginary) {
  Hdf5Id type(H5Tcreate(H5T_COMPOUND, 2 * sizeof(double)), H5Tclose);
  H5Tinsert(type.get(), real.c_str(), 0, H5T_NATIVE_DOUBLE);
  H5Tinsert(type.get(), imaginary.c_str(), sizeof(double), H5T_NATIVE_DOUBLE);
  return type;
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

Hdf5Id complex_as_numpy() { return pair_of_doubles("r", "i"); }

Hdf5Id complex_in_memory(hid_t stored) {
  return pair_of_doubles(member_name(stored, 0), member_name(stored, 1));
}

}  // namespace modcal
