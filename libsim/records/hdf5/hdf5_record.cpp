#include "libsim/records/hdf5/hdf5_content.hpp"
#include "libsim/records/hdf5/hdf5_file.hpp"

namespace modcal {

Recording read_hdf5(const std::filesystem::path& path, const ReadOptions& options) {
  return recording_of(std::make_shared<Hdf5Content>(path), "HDF5 file", path, options);
}

ResponseFunctions read_hdf5_responses(const std::filesystem::path& path,
                                      const std::vector<std::string>& channels,
                                      FrequencyFunction wanted) {
  return responses_of(std::make_shared<Hdf5Content>(path), path, channels, wanted);
}

}  // namespace modcal
