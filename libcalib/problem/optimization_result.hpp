// What a search leaves.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
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

/// A stage of a search that has ended.
struct FitStage {
  std::string name;             ///< "law, sigma = 100 1/s"
  std::size_t evaluations = 0;  ///< so far, those of all stages before included
  double objective = 0.0;       ///< what it minimized, of its own record
  /// Reduced, of the stage's own record, that of the whole one where bins are weighted; NaN: not
  /// found.
  double chi2 = std::numeric_limits<double>::quiet_NaN();
};

struct ContinuationResult;

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
  std::vector<FitStage> stages;  ///< of a search in stages
  /// What a schedule of stages says of its own result; null: the search had none.
  std::shared_ptr<const ContinuationResult> estimate;
  std::vector<CoordinateScan> scans;  ///< of the first and of the last loop
};

}  // namespace modcal
