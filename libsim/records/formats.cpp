#include "libsim/records/formats.hpp"

#include <algorithm>

#include "libsim/base/error.hpp"
#include "libsim/base/words.hpp"
#include "libsim/records/hdf5/hdf5_file.hpp"
#include "libsim/records/labview/lvm_file.hpp"
#include "libsim/records/matlab/matlab_file.hpp"
#include "libsim/records/numpy/numpy_file.hpp"
#include "libsim/records/universal/universal_file.hpp"

namespace modcal {
namespace {

using Path = std::filesystem::path;

const std::vector<RecordFormat>& table() {
  static const std::vector<RecordFormat> formats = {
      {"csv",
       "columns of text",
       {".csv", ".tsv", ".txt"},
       read_csv,
       [](const Path& path, std::span<const Signal> signals, const std::string& provenance) {
         write_csv(path, signals, {.provenance = {provenance}});
       },
       read_csv_responses},
      {"wav",
       "WAV and other sound files",
       {".wav", ".wave", ".rf64", ".bwf", ".w64"},
       read_wav,
       [](const Path& path, std::span<const Signal> signals, const std::string& provenance) {
         write_wav(path, signals, {.samples = WavSamples::kDouble, .provenance = provenance});
       }},
      {"uff",
       "universal files, datasets 58 and 58b",
       {".uff", ".unv", ".uf58"},
       read_universal,
       write_universal,
       read_universal_responses},
      {"mat",
       "MAT files of MATLAB and Octave",
       {".mat"},
       read_matlab,
       write_matlab,
       read_matlab_responses},
      {"npy", "an array of NumPy", {".npy"}, read_npy, write_npy, read_npy_responses},
      {"npz", "archives of NumPy", {".npz"}, read_npz, write_npz, read_npz_responses},
      {"hdf5", "HDF5 files", {".h5", ".hdf5", ".hdf"}, read_hdf5, write_hdf5, read_hdf5_responses},
      {"lvm", "LabVIEW measurement files", {".lvm"}, read_lvm, write_lvm},
  };
  return formats;
}

}  // namespace

std::span<const RecordFormat> record_formats() { return table(); }

std::vector<std::string_view> record_format_choices() {
  std::vector<std::string_view> names = {"auto"};
  for (const RecordFormat& format : table()) names.push_back(format.name);
  return names;
}

const RecordFormat& record_format(const Path& path, const std::string& name) {
  const std::string extension = lower_case(path.extension().string());
  const bool told = name == "auto";
  const auto found = std::find_if(table().begin(), table().end(), [&](const RecordFormat& format) {
    const auto& known = format.extensions;
    return told ? std::find(known.begin(), known.end(), extension) != known.end()
                : format.name == name;
  });
  if (found != table().end()) return *found;
  const std::vector<std::string_view> names = record_format_choices();
  MODCAL_REQUIRE(told, "unknown format \"{}\" of a record: {}", name, fmt::join(names, ", "));
  throw_invalid_input("{}: the extension \"{}\" does not tell the format; state format: {}",
                      path.string(), extension, fmt::join(std::span(names).subspan(1), ", "));
}

ResponseFunctions read_response_functions(const Path& path, const std::string& format,
                                          const std::vector<std::string>& channels,
                                          FrequencyFunction wanted) {
  const RecordFormat& known = record_format(path, format);
  MODCAL_REQUIRE(
      known.read_responses != nullptr,
      "{}: {} keep no response functions: state a universal file (UFF 58), CSV, MAT, NumPy or HDF5",
      path.string(), known.meaning);
  return known.read_responses(path, channels, wanted);
}

}  // namespace modcal
