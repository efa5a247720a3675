// What a file of arrays by names is written from.
#pragma once

#include <cmath>
#include <span>
#include <string>
#include <vector>

#include "libsim/records/record_file.hpp"
#include "libsim/records/response_functions.hpp"

namespace modcal {

/// A vector of numbers; of a complex one real and imaginary part of each value in turn.
struct WrittenArray {
  std::string name, unit;
  std::span<const double> numbers;
  bool is_complex = false;

  std::size_t size() const { return numbers.size() / (is_complex ? 2 : 1); }
};

/// The number [s] that tells when a record begins, where it is not at 0.
inline constexpr const char* kStart = "t0";

/// Vectors of one length with what tells their axis: `sample_rate` [Hz], a number, or `f` [Hz], a
/// vector. The signals or functions that they are made of must outlive them.
struct WrittenArrays {
  std::string axis;
  std::span<const double> axis_values;
  std::vector<WrittenArray> arrays;
  std::string provenance;
  double start = 0.0;                     ///< of the first sample [s]
  std::vector<std::vector<double>> kept;  ///< numbers that stand nowhere else

  bool has_lines() const { return axis_values.size() > 1; }
  bool has_start() const { return std::abs(start) > 0.0; }
  /// Whether a reader would take an array of this name for the axis.
  bool is_for_axis(const std::string& name) const;
};

/// Throws InvalidInput as require_one_record() does.
WrittenArrays written_arrays(std::span<const Signal> signals, const RecordNotes& notes,
                             const std::string& file);

/// Of functions of the same lines. Throws InvalidInput as require_functions() does.
WrittenArrays written_arrays(std::span<const FileFunction> functions, const std::string& provenance,
                             const std::string& file);

}  // namespace modcal
