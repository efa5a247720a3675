// What a search leaves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "libcalib/problem/stop_reason.hpp"

namespace modcal {

/// A value better than all before it.
struct TracePoint {
  std::int64_t evaluations = 0;  ///< evaluations so far, this one included
  double seconds = 0.0;
  double value = 0.0;
};

/// Candidates of one variable with their objective values.
struct CoordinateScan {
  std::size_t variable = 0;  ///< index
  std::int64_t loop = 0;     ///< from 1
  double center = 0.0;       ///< the variable before the scan
  double chosen = 0.0;       ///< the variable after it
  std::vector<double> candidates;
  std::vector<double> values;
};

struct OptimizationResult {
  StopReason stop = StopReason::kNotRun;
  std::vector<double> x;  ///< in user units
  double value = std::numeric_limits<double>::quiet_NaN();
  double initial_value = std::numeric_limits<double>::quiet_NaN();
  std::int64_t evaluations = 0;
  /// How many of them went into slopes that the objective does not give.
  std::int64_t difference_evaluations = 0;
  std::int64_t loops = 0;  ///< of a search that repeats itself over the variables
  /// How many variables each completed loop searched: all, save those that were left out as
  /// settled.
  std::vector<std::int64_t> searched;
  /// Searches of a variable left out in all loops; the first loop searches all.
  std::int64_t left_out() const {
    std::int64_t count = 0;
    for (const std::int64_t made : searched) count += searched.front() - made;
    return count;
  }
  double seconds = 0.0;
  std::vector<TracePoint> trace;
  std::vector<CoordinateScan> scans;  ///< of the first and of the last loop
};

}  // namespace modcal
