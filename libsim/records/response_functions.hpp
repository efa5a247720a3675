// Measured response functions of frequency, as files keep them.
#pragma once

#include "libsim/model/modal_model.hpp"
#include "libsim/records/recording.hpp"

namespace modcal {

/// What a function over frequency is: H, or how much of a response the force explains (γ²).
enum class FrequencyFunction { kResponse, kCoherence };

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

/// Of a CSV file: a column frequency [Hz], and for each function "NAME" or "NAME real" with "NAME
/// imaginary", or "NAME" with "NAME phase [deg]" or [rad]; a column by itself is a coherence.
ResponseFunctions read_csv_responses(const std::filesystem::path& path,
                                     const std::vector<std::string>& channels,
                                     FrequencyFunction wanted);

}  // namespace modcal
