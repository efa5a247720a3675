// Calibration of the modal model: from an initial model and reactions to a refined model.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "libcalib/identifiability/continuation_result.hpp"
#include "libcalib/optimizer.hpp"
#include "libcalib/problem.hpp"
#include "libcalib/problem/budget.hpp"
#include "libcalib/problem/calibration_data.hpp"
#include "libcalib/problem/optimization_result.hpp"

namespace modcal {

/// Section "calibration" of an experiment. Unless told otherwise everything is free and the joint
/// likelihood is maximized in stages.
struct CalibrationOptions {
  ParameterOptions parameters{.frequencies = "all", .law = true, .contact = true};
  Choice<Objective> objective{"joint_likelihood"};
  Choice<Optimizer> optimizer{"staged"};
  Budget budget;
  /// Modes with |φ_n(x_c)| below this are blind: nothing in the reactions tells their frequency
  /// [1].
  double excitation_threshold = 0.1;
  SupportOptions support;
  void visit(OptionVisitor& visitor);
  Problem problem(const ModelPoint& initial, std::vector<CalibrationRecord> records) const;
  /// Whether the optimizer follows the objective's own schedule of stages.
  bool by_schedule() const;
  /// Throws InvalidInput where it does not, or does not read the parameters of one stroke.
  void require_schedule() const;
  /// Throws InvalidInput for parameters that the search of so many records does not read.
  void require_read(std::size_t strokes, std::size_t plucks = 0) const;
};

/// Calibration to the bound: the joint likelihood in stages over law, contact, one damping factor
/// and every frequency.
CalibrationOptions calibration_to_the_bound();
/// The paper's: every frequency by the spectral peak, mode by mode (Debut, Delaune and Antunes
/// 2010, section 6).
CalibrationOptions calibration_of_the_paper();

struct CalibratedParameter {
  std::string name;
  std::string unit;
  double initial = 0.0;
  double final = 0.0;
  bool at_bound = false;  ///< the search ended on a bound: the optimum may lie beyond
  /// Standard deviation: of a schedule to the bound; of a search that reached an optimum of a
  /// whitened objective by its residuals, within the bounds (covariance_at(), which counts noise as
  /// information: too small where the data tell little). NaN: not known.
  double deviation = std::numeric_limits<double>::quiet_NaN();
};

/// One mode before and after.
struct CalibratedMode {
  std::size_t number = 0;          ///< n
  double initial_frequency = 0.0;  ///< [Hz]
  double frequency = 0.0;          ///< [Hz]
  double shape = 0.0;              ///< φ_n at the initial contact; by a schedule at the one found
  bool excited = false;            ///< |φ_n| ≥ the threshold
  bool searched = false;           ///< its frequency was a free parameter of its own
};

struct CalibrationResult {
  std::vector<CalibratedParameter> parameters;  ///< those searched; scans name them by index
  std::vector<CalibratedMode> modes;            ///< all modes of the model
  /// Names of parameters that were asked for and not searched: frequencies of blind modes. They
  /// keep their initial values.
  std::vector<std::string> blind;
  ModelPoint model;  ///< refined
  OptimizationResult search;
  /// Error bars, status of modes, χ²; null: the search had no schedule of its own.
  std::shared_ptr<const ContinuationResult> continuation;
};

/// Marks the modes with |φ_n(x_c)| ≥ threshold.
std::vector<bool> excited_modes(const ModelPoint& point, double threshold);

/// A problem as a search sees it: a function of free parameters with bounds and a start.
struct BoundProblem {
  Problem problem;  ///< with what is meant where nothing is stated
  ParameterSet parameters;
  std::unique_ptr<const ObjectiveFunction> function;
  std::vector<std::string> blind;   ///< asked for and left out, see CalibrationResult
  std::vector<HeldParameter> held;  ///< asked for and fixed
};

/// Throws InvalidInput where objective, optimizer, records and parameters do not fit together.
BoundProblem bind(const Problem& problem, const Optimizer& optimizer);

/// Minimizes the objective over the parameters asked for, save the frequencies of blind modes. What
/// each further record has for itself follows among the parameters with its number, "x_c 2",
/// "gain 3". The clock is read before every evaluation. Throws InvalidInput where objective,
/// optimizer, records and parameters do not fit together, before the first evaluation.
CalibrationResult calibrate(const Problem& problem, const Optimizer& optimizer,
                            const Budget& budget = {}, SecondsClock clock = steady_seconds());

/// The same as an experiment states it.
CalibrationResult calibrate(const ModelPoint& initial, std::vector<CalibrationRecord> records,
                            const CalibrationOptions& options,
                            SecondsClock clock = steady_seconds());
/// One stroke.
CalibrationResult calibrate(const ModelPoint& initial, const CalibrationData& data,
                            const CalibrationOptions& options,
                            SecondsClock clock = steady_seconds());

}  // namespace modcal
