#include "libsim/records/formats.hpp"

#include <algorithm>

#include "libsim/base/error.hpp"
#include "libsim/base/files.hpp"
#include "libsim/base/words.hpp"
#include "libsim/records/arrays/written_arrays.hpp"
#include "libsim/records/csv/csv_table.hpp"
#include "libsim/records/hdf5/hdf5_file.hpp"
#include "libsim/records/labview/lvm_file.hpp"
#include "libsim/records/matlab/matlab_file.hpp"
#include "libsim/records/numpy/numpy_file.hpp"
#include "libsim/records/universal/universal_file.hpp"

namespace modcal {
namespace {

using Path = std::filesystem::path;

// Of formats that hold arrays by names.
template <auto kWrite, typename What, typename Notes>
void write_as_arrays(const Path& path, std::span<const What> what, const Notes& notes) {
  kWrite(path, written_arrays(what, notes, path.string()));
}
template <auto kWrite>
constexpr auto write_signals = write_as_arrays<kWrite, Signal, RecordNotes>;
template <auto kWrite>
constexpr auto write_function_arrays = write_as_arrays<kWrite, FileFunction, std::string>;

const std::vector<RecordFormat>& table() {
  static const std::vector<RecordFormat> formats = {
      {"csv",
       "columns of text",
       {".csv", ".tsv", ".txt"},
       read_csv,
       [](const Path& path, std::span<const Signal> signals, const RecordNotes& notes) {
         write_csv(path, signals, {.provenance = {notes.provenance}, .start = notes.start});
       },
       csv_functions,
       write_csv_functions},
      {"wav",
       "WAV and other sound files",
       {".wav", ".wave", ".rf64", ".bwf", ".w64"},
       read_wav,
       [](const Path& path, std::span<const Signal> signals, const RecordNotes& notes) {
         write_wav(path, signals, {.samples = WavSamples::kDouble, .provenance = notes.provenance});
       },
       nullptr,
       nullptr,
       false,
       true},
      {"uff",
       "universal files, datasets 58 and 58b",
       {".uff", ".unv", ".uf58"},
       read_universal,
       write_universal,
       universal_functions,
       write_universal_functions,
       true},
      {"mat",
       "MAT files of MATLAB and Octave",
       {".mat"},
       read_matlab,
       write_signals<write_matlab>,
       matlab_functions,
       write_function_arrays<write_matlab>},
      {"npy", "an array of NumPy", {".npy"}, read_npy, write_npy, npy_functions},
      {"npz",
       "archives of NumPy",
       {".npz"},
       read_npz,
       write_signals<write_npz>,
       npz_functions,
       write_function_arrays<write_npz>},
      {"hdf5",
       "HDF5 files",
       {".h5", ".hdf5", ".hdf"},
       read_hdf5,
       write_signals<write_hdf5>,
       hdf5_functions,
       write_function_arrays<write_hdf5>},
      {"lvm", "LabVIEW measurement files", {".lvm"}, read_lvm, write_lvm},
  };
  return formats;
}

std::vector<StoredChannel> stored_functions(const Path& path, const RecordFormat& format) {
  MODCAL_REQUIRE(
      format.functions != nullptr,
      "{}: {} keep no response functions: state a universal file (UFF 58), CSV, MAT, NumPy or HDF5",
      path.string(), format.meaning);
  return format.functions(path);
}

// Those that can stand in one file of the format; the others are warnings, as are channels of
// another grid where a record is read.
void keep_possible(const RecordFormat& format, const std::string& file, FileFunctions& all) {
  if (format.keeps_any_function) return;
  const auto is_power = [](const FileFunction& function) {
    return function.what != FrequencyFunction::kResponse &&
           function.what != FrequencyFunction::kCoherence;
  };
  std::vector<FileFunction> kept;
  for (FileFunction& function : all.functions) {
    const bool has_other_lines = !kept.empty() && function.hertz != kept.front().hertz;
    if (!is_power(function) && !has_other_lines) {
      kept.push_back(std::move(function));
      continue;
    }
    all.warnings.push_back(fmt::format(
        "{}: \"{}\" [{}] is left out: {}; a universal file (.uff) holds it", file, function.name,
        function.whole_unit(),
        is_power(function)
            ? fmt::format("{} hold no {}", format.meaning, text_of(function.what))
            : fmt::format("{} hold functions of the same frequencies alone, and it has others than "
                          "\"{}\"",
                          format.meaning, kept.front().name)));
  }
  all.functions = std::move(kept);
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
  return assemble_responses(stored_functions(path, record_format(path, format)), channels, wanted,
                            path.string());
}

FileFunctions read_functions(const Path& path, const std::string& format) {
  return assemble_functions(stored_functions(path, record_format(path, format)), path.string());
}

bool has_functions_alone(const Path& path, const std::string& format, double memory) {
  require_regular_file(path);  // before its name is asked for a format
  const RecordFormat& known = record_format(path, format);
  if (known.functions == nullptr) return false;
  const Recording heads = known.read(path, {.survey = true, .headers_only = true});
  // What tells a rate is a record in time.
  if (!heads.channels.empty() && !heads.rate_source.empty()) return false;
  require_memory(path, format, memory);
  // Real vectors beside a vector f may be anything, unless a response function stands there.
  const std::vector<StoredChannel> stored = known.functions(path);
  return std::ranges::any_of(stored, [&heads](const StoredChannel& channel) {
    return channel.read_response &&
           (channel.what != FrequencyFunction::kCoherence || heads.channels.empty());
  });
}

std::size_t write_functions(const Path& path, const std::string& format, FileFunctions& functions,
                            const std::string& provenance) {
  const RecordFormat& known = record_format(path, format);
  std::vector<std::string_view> able;
  for (const RecordFormat& other : table()) {
    if (other.write_functions != nullptr) able.push_back(other.name);
  }
  MODCAL_REQUIRE(known.write_functions != nullptr,
                 "{}: functions of frequency are not written as {} ({}); these formats hold them: "
                 "{}",
                 path.string(), known.name, known.meaning, fmt::join(able, ", "));
  MODCAL_REQUIRE(!functions.functions.empty(), "{}: there is no function of frequency to write",
                 path.string());
  keep_possible(known, path.string(), functions);
  MODCAL_REQUIRE(!functions.functions.empty(), "{}", fmt::join(functions.warnings, "\n"));
  known.write_functions(path, functions.functions, provenance);
  return functions.functions.size();
}

}  // namespace modcal
