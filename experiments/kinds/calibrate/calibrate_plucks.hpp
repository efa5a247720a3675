// Plucks that a calibration fits together with its strokes.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "experiments/experiment.hpp"
#include "experiments/study/observation.hpp"
#include "libcalib/problem/calibration_data.hpp"

namespace modcal {

struct CalibrationOptions;
struct StudyContext;

/// One pluck of the string that is calibrated: simulated, the scene without its bow, or a recorded
/// file laid out as that of the stroke, which begins when the string has been let go.
struct PluckRecordOptions {
  Choice<InitialMotion> start{"rest"};  ///< a simulated one needs to be plucked
  double duration = 1.0;                ///< [s]
  double noise_level = 0.01;            ///< of a simulated pluck [1]
  double sample_rate = 51200.0;         ///< of a simulated pluck [Hz]
  std::string file;                     ///< empty: simulated
  /// Noise standard deviation of each reaction [N]; NaN: estimated from the record.
  double left_noise = std::numeric_limits<double>::quiet_NaN();
  double right_noise = std::numeric_limits<double>::quiet_NaN();
  void visit(OptionVisitor& visitor);
  /// As an observation: the scene of the first stroke without its bow, or the other file.
  ObservationOptions observation(const ObservationOptions& first) const;
};

/// What is wrong with each pluck, at its own place: plucks that do not fit to the first stroke or
/// to what is calibrated, a plucking point beyond the string, a decay too short to tell its modes
/// apart.
std::vector<Finding> lint_plucks(const std::vector<PluckRecordOptions>& plucks,
                                 const ObservationOptions& first,
                                 const CalibrationOptions& calibration);

/// Throws InvalidInput with the first of these.
void require_plucks(const std::vector<PluckRecordOptions>& plucks, const ObservationOptions& first,
                    const CalibrationOptions& calibration);

/// The reactions of every pluck, simulated (through the cache) or read; noise of their own.
std::vector<CalibrationRecord> observe_plucks(const std::vector<PluckRecordOptions>& plucks,
                                              const ObservationOptions& first, const StreamKey& key,
                                              const StudyContext& context);

}  // namespace modcal
