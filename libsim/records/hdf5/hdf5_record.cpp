#include "libsim/records/hdf5/hdf5_content.hpp"
#include "libsim/records/hdf5/hdf5_file.hpp"

namespace modcal {

Recording read_hdf5(const std::filesystem::path& path, const ReadOptions& options) {
  return recording_of(std::make_shared<Hdf5Content>(path), "HDF5 file", path, options);
}

std::vector<StoredChannel> hdf5_functions(const std::filesystem::path& path) {
  return functions_of(std::make_shared<Hdf5Content>(path), path);
}

}  // namespace modcal
