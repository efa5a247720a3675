// Outcome of one task of a benchmark: a calibration scored on the truth.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "libcalib/problem/stop_reason.hpp"

namespace modcal {

struct BenchmarkOutcome {
  /// Why there is no calibration (refused, broken); empty: there is one.
  std::string failure;
  StopReason stop = StopReason::kNotRun;
  std::int64_t evaluations = 0;
  double initial_value = std::numeric_limits<double>::quiet_NaN();  ///< of the objective
  double value = std::numeric_limits<double>::quiet_NaN();          ///< at the end
  double truth_value = std::numeric_limits<double>::quiet_NaN();    ///< at the true model
  double initial_error = std::numeric_limits<double>::quiet_NaN();
  /// Median of |f_n − true|/true over the modes that the contact excites.
  double frequency_error = std::numeric_limits<double>::quiet_NaN();
  double frequency_rms_error = std::numeric_limits<double>::quiet_NaN();  ///< over the same modes
  /// Cramér–Rao bound of frequency_rms_error; NaN without noise.
  double frequency_bound = std::numeric_limits<double>::quiet_NaN();
  double contact_error = std::numeric_limits<double>::quiet_NaN();  ///< |x_c − true| [m]
  /// Mean correlation of identified and true force over sides and windows.
  double correlation = std::numeric_limits<double>::quiet_NaN();
  bool success = false;
  /// Evaluations so far and best value, at the improvements; thinned to 100.
  std::vector<std::pair<std::int64_t, double>> trace;

  /// frequency_rms_error over its bound; NaN without a bound.
  double bound_ratio() const { return frequency_rms_error / frequency_bound; }
};

/// JSON on one line; read_benchmark_outcome gives back every bit.
std::string outcome_text(const BenchmarkOutcome& outcome);
/// Throws InvalidInput for a text that outcome_text did not write.
BenchmarkOutcome read_benchmark_outcome(const std::string& text);

/// Why a task did not succeed, in words that can be counted; empty where it did.
std::string reason_of(const BenchmarkOutcome& outcome);

}  // namespace modcal
