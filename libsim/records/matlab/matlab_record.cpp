#include "libsim/records/matlab/matlab_content.hpp"
#include "libsim/records/matlab/matlab_file.hpp"

namespace modcal {

Recording read_matlab(const std::filesystem::path& path, const ReadOptions& options) {
  return recording_of(std::make_shared<MatlabContent>(path), "MAT file", path, options);
}

std::vector<StoredChannel> matlab_functions(const std::filesystem::path& path) {
  return functions_of(std::make_shared<MatlabContent>(path), path);
}

}  // namespace modcal
