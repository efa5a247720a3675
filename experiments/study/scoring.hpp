// How close an identified signal comes to the true one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "libsim/base/options.hpp"
#include "libsim/signal/signal.hpp"

namespace modcal {

/// Windows over which an identified force is compared with the true one.
struct ScoreOptions {
  std::vector<double> windows;  ///< starts [s]; none: the whole record at once
  double periods = 2.0;         ///< length in periods of the fundamental
  void visit(OptionVisitor& visitor);
};

struct WindowScore {
  double start = 0.0;               ///< [s]
  double correlation = 0.0;         ///< R of eq. 16
  double relative_rms_error = 0.0;  ///< static parts removed
};

/// Scores over every window of `periods`/`fundamental` seconds. Throws InvalidInput where a window
/// leaves the record.
std::vector<WindowScore> score_windows(const Signal& identified, const Signal& truth,
                                       const ScoreOptions& options, double fundamental);

}  // namespace modcal
