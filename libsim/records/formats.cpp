#include "libsim/records/formats.hpp"

#include <algorithm>
#include <cctype>

#include "libsim/base/error.hpp"
#include "libsim/base/words.hpp"
#include "libsim/records/matlab/matlab_file.hpp"
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
       false},
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
       write_universal},
      {"mat", "MAT files of MATLAB and Octave", {".mat"}, read_matlab, write_matlab},
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
  std::string extension = path.extension().string();
  for (char& letter : extension) {
    letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
  }
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

}  // namespace modcal
