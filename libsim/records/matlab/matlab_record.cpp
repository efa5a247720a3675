#include "libsim/records/matlab/matlab_content.hpp"
#include "libsim/records/matlab/matlab_file.hpp"

namespace modcal {

Recording read_matlab(const std::filesystem::path& path, const ReadOptions& options) {
  return recording_of(std::make_shared<MatlabContent>(path), "MAT file", path, options);
}

ResponseFunctions read_matlab_responses(const std::filesystem::path& path,
                                        const std::vector<std::string>& channels,
                                        FrequencyFunction wanted) {
  return responses_of(std::make_shared<MatlabContent>(path), path, channels, wanted);
}

}  // namespace modcal
