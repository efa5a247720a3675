// Universal files (UFF, UNV) of modal analysis: the functions of datasets 58 and 58b.
#pragma once

#include <complex>
#include <optional>

#include "libsim/records/stored_channels.hpp"
#include "libsim/records/universal/line_file.hpp"

namespace modcal {

/// One axis of a function.
struct UniversalAxis {
  int code = 0;                    ///< specific data type: 17 time, 12 acceleration, …
  std::array<int, 3> exponents{};  ///< of length, force, temperature
  std::string label, unit;         ///< as the file has them; "NONE" is empty
};

/// One function; its numbers are read by read_universal_values().
struct UniversalFunction {
  int type = 0;  ///< 0 general, 1 time, 2 auto spectrum, 3 cross spectrum, 4 FRF, 6 coherence, …
  std::string name;  ///< entity with node and direction, or the ID line
  std::array<std::string, 5> id_lines;
  MeasuredPlaces places;
  bool is_double = false, is_complex = false, is_even = true;
  std::uint64_t size = 0;
  double first = 0.0, step = 0.0;  ///< of the abscissa, where it is even
  double step_resolution = 0.0;    ///< relative, as the step was printed
  UniversalAxis abscissa, ordinate, denominator;
  bool binary = false, little_endian = true;
  bool abscissa_is_single = false;  ///< floats beside doubles
  std::uint64_t byte_count = 0;     ///< of binary values
  FilePlace header, values;         ///< where they begin
};

/// Units of dataset 164: what the numbers of the file are divided by to be SI.
struct UniversalUnits {
  int code = 1;
  std::array<double, 3> factors = {1.0, 1.0, 1.0};  ///< length, force, temperature
};

struct UniversalFile {
  std::vector<UniversalFunction> functions;
  std::optional<UniversalUnits> units;  ///< none stated: SI
  std::vector<FilePlace> shapes;        ///< where datasets 55 begin, behind their number
  std::vector<int> other_datasets;      ///< numbers of those that are passed over, once each
};

/// Reads headers alone. Throws InvalidInput with line, byte and dataset.
UniversalFile read_universal_headers(const std::filesystem::path& path);

/// The numbers of a function: the abscissa (empty where it is even) and the values; imaginary parts
/// are 0 for real ones.
struct UniversalValues {
  std::vector<double> abscissa;
  std::vector<std::complex<double>> values;
};
UniversalValues read_universal_values(const std::filesystem::path& path,
                                      const UniversalFunction& function,
                                      const StopToken& stop = {});

/// The functions of time as channels.
Recording read_universal(const std::filesystem::path& path, const ReadOptions& options = {});

/// Its functions, those of frequency with their lines.
std::vector<StoredChannel> universal_functions(const std::filesystem::path& path);

/// One dataset 58b in doubles for each signal.
void write_universal(const std::filesystem::path& path, std::span<const Signal> signals,
                     const RecordNotes& notes);

/// The same for each function of frequency, as what it is, with even lines where a formula gives
/// them to the last bit. Throws InvalidInput as write_functions() says, and for names and units
/// that are too long.
void write_universal_functions(const std::filesystem::path& path,
                               std::span<const FileFunction> functions,
                               const std::string& provenance);

}  // namespace modcal
