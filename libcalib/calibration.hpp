// Calibration of the modal model: from an initial model and reactions to a refined model.
#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libcalib/problem/budget.hpp"
#include "libcalib/problem/calibration_data.hpp"
#include "libcalib/optimizers/staged/records_fit.hpp"
#include "libcalib/objective.hpp"
#include "libcalib/problem/optimization_result.hpp"
#include "libcalib/optimizer.hpp"
#include "libcalib/parameters/parameters.hpp"

namespace modcal {

/// Section "calibration" of an experiment.
struct CalibrationOptions {
  ParameterOptions parameters;
  Choice<Objective> objective{"spectral_peak"};
  Choice<Optimizer> optimizer{"mode_by_mode"};
  Budget budget;
  /// Continuation of the joint likelihood in the place of objective and optimizer: x_c, the law and
  /// one damping factor are free, and with frequencies: all every f_n.
  bool has_continuation = false;
  ContinuationOptions continuation;
  /// Modes with |φ_n(x_c)| below this are blind: nothing in the reactions tells their frequency
  /// [1].
  double excitation_threshold = 0.1;
  void visit(OptionVisitor& visitor);
};

struct CalibratedParameter {
  std::string name;
  std::string unit;
  double initial = 0.0;
  double final = 0.0;
  bool at_bound = false;  ///< the search ended on a bound: the optimum may lie beyond
  /// Standard deviation: of a continuation; of a search that reached an optimum of a whitened
  /// objective by its residuals, within the bounds (covariance_at(), which counts noise as
  /// information: too small where the data tell little). NaN: not known.
  double deviation = std::numeric_limits<double>::quiet_NaN();
};

/// One mode before and after.
struct CalibratedMode {
  std::size_t number = 0;          ///< n
  double initial_frequency = 0.0;  ///< [Hz]
  double frequency = 0.0;          ///< [Hz]
  double shape = 0.0;     ///< φ_n at the initial contact; of a continuation at the one found
  bool excited = false;   ///< |φ_n| ≥ the threshold
  bool searched = false;  ///< its frequency was a free parameter of its own
};

struct CalibrationResult {
  std::vector<CalibratedParameter> parameters;  ///< those searched; scans name them by index
  std::vector<CalibratedMode> modes;            ///< all modes of the model
  /// Names of parameters that were asked for and not searched: frequencies of blind modes. They
  /// keep their initial values.
  std::vector<std::string> blind;
  ModelPoint model;  ///< refined
  OptimizationResult search;
  std::optional<ContinuationResult> continuation;  ///< error bars, verdicts, χ²
  std::vector<double> contact_deviations;          ///< of every record [m], with a continuation
};

/// Marks the modes with |φ_n(x_c)| ≥ threshold.
std::vector<bool> excited_modes(const ModelPoint& point, double threshold);

/// Throws InvalidInput for parameters that a continuation over `strokes` strokes does not read.
void require_continuation_parameters(const ParameterOptions& parameters, std::size_t strokes);

/// Minimizes the objective over the parameters asked for, save the frequencies of blind modes.
/// Throws InvalidInput where objective, optimizer, data and parameters do not fit together, before
/// the first evaluation.
CalibrationResult calibrate(const ModelPoint& initial, const CalibrationData& data,
                            const CalibrationOptions& options,
                            SecondsClock clock = steady_seconds());

/// Several records of one string (calibrate_records): what each has for itself follows among the
/// parameters with the number of the record, "x_c 2", "gain 3". More than one needs `continuation`.
CalibrationResult calibrate(const ModelPoint& initial, std::span<const CalibrationData> records,
                            const CalibrationOptions& options,
                            SecondsClock clock = steady_seconds());
/// The same with plucks of that string, which need `continuation` too. The clock is read before
/// every evaluation of a continuation as of a search.
CalibrationResult calibrate(const ModelPoint& initial, std::span<const CalibrationData> strokes,
                            std::span<const PluckRecord> plucks, const CalibrationOptions& options,
                            SecondsClock clock = steady_seconds());

}  // namespace modcal
