// Measured functions of frequency, as files keep them.
#pragma once

#include "libsim/model/modal_model.hpp"
#include "libsim/records/recording.hpp"

namespace modcal {

/// What a function over frequency is: H, how much of a response the force explains (γ²), or the
/// power of one channel, in bins or a hertz.
enum class FrequencyFunction { kResponse, kCoherence, kAutoSpectrum, kPowerDensity };

/// For people: "coherence".
std::string_view text_of(FrequencyFunction what);

/// H at the lines of a grid from 0 on; NaN below the first line that the file has.
struct ResponseFunction {
  std::string name;
  std::string kind;            ///< what the sensor reads ("acceleration"); empty: not told
  std::string unit, per_unit;  ///< of the response and of the force; empty: not told
  double full_scale = 1.0;     ///< of values whose units are told, else SI per value
  std::vector<Complex> values;
};

struct ResponseFunctions {
  FrequencyGrid grid;
  std::vector<ResponseFunction> functions;
};

/// The functions named, by name or by number from 1 among all that the file holds, of one grid.
/// Throws WrongChannel for one that is not there, is none of what is wanted or has another grid,
/// and InvalidInput for a format that keeps none.
ResponseFunctions read_response_functions(const std::filesystem::path& path,
                                          const std::string& format,
                                          const std::vector<std::string>& channels,
                                          FrequencyFunction wanted = FrequencyFunction::kResponse);

/// Where a universal file says that a function was measured; 0: not told.
struct MeasuredPlaces {
  int response_node = 0, response_direction = 0, reference_node = 0, reference_direction = 0;
  bool operator==(const MeasuredPlaces&) const = default;
};

/// A function at the lines that its file has, even or not: its values alone, in its units.
struct FileFunction : ResponseFunction {
  FrequencyFunction what = FrequencyFunction::kResponse;
  std::vector<double> hertz;  ///< [Hz], as many as values; they increase
  MeasuredPlaces places = {};

  bool is_real() const { return what != FrequencyFunction::kResponse; }
  /// "m/s2" per "N" as one text; empty where neither is told.
  std::string whole_unit() const;
};

struct FileFunctions {
  std::vector<FileFunction> functions;
  std::vector<std::string> warnings;  ///< what is left out, and why
};

/// All functions of frequency of a file, with the numbers and names that read_response_functions()
/// gives, and every line to the last bit. Throws InvalidInput for a format that keeps none and for
/// a file that cannot be used.
FileFunctions read_functions(const std::filesystem::path& path, const std::string& format);

/// Whether a file holds functions of frequency and nothing that tells a record in time. Throws
/// InvalidInput for a file that cannot be used, and for one whose reading needs more than `memory`
/// [B].
bool has_functions_alone(const std::filesystem::path& path, const std::string& format,
                         double memory);

/// Writes the functions in the named format, or for "auto" in that of the extension, so that
/// read_functions() gives them again; an existing file is replaced only when the new one is
/// complete. Those that the format cannot hold are left out, a warning for each. Returns how many
/// are written. Throws InvalidInput for a format that holds none of them, values that are not
/// finite, and where the file cannot be written.
std::size_t write_functions(const std::filesystem::path& path, const std::string& format,
                            FileFunctions& functions, const std::string& provenance);

}  // namespace modcal
