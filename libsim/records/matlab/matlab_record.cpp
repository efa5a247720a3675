#include "libsim/records/hdf5/hdf5_content.hpp"
#include "libsim/records/matlab/matlab_content.hpp"
#include "libsim/records/matlab/matlab_file.hpp"

namespace modcal {
namespace {

// Numbers that libmatio passes over are datasets still.
std::shared_ptr<ArrayFile> content_of(const std::filesystem::path& path) {
  auto content = std::make_shared<MatlabContent>(path);
  if (content->is_complete()) return content;
  return std::make_shared<Hdf5Content>(path, true);
}

}  // namespace

Recording read_matlab(const std::filesystem::path& path, const ReadOptions& options) {
  return recording_of(content_of(path), "MAT file", path, options);
}

std::vector<StoredChannel> matlab_functions(const std::filesystem::path& path) {
  return functions_of(content_of(path), path);
}

}  // namespace modcal
