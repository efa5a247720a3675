// Kind "benchmark": calibrations over objectives, optimizers and data, scored on the truth and held
// against what the data allow at best.
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "experiments/kinds/calibrate/calibrate_study.hpp"
#include "experiments/study/computed_once.hpp"
#include "libsim/base/result_visitor.hpp"

namespace modcal {

/// Cramér–Rao bounds of the modal frequencies, computed once for each scene, noise level and set of
/// unknowns. Safe to use from several threads.
class FrequencyBounds {
 public:
  using Bounds = std::shared_ptr<const std::vector<double>>;
  /// Relative standard deviation of f_1 … f_N that no unbiased estimate of both reactions with the
  /// force unknown goes below, damping and sensors free as far as they are calibrated: of the
  /// stiff-string law where it is free (x_c known unless it is calibrated), of every frequency
  /// under the law prior and what priors are stated where frequencies are free. Null
  /// without noise or where no frequency is free. Throws InvalidInput as expected_limit() does.
  Bounds of(const CalibrateOptions& options, TruthCache& truths);

 private:
  ComputedOnce<Bounds> known_;
};

/// √(mean of b_n²) over the modes n listed; NaN for null bounds or no mode.
double rms_bound(const FrequencyBounds::Bounds& bounds, const std::vector<std::size_t>& modes);

/// When a calibration counts as successful.
struct SuccessOptions {
  static constexpr bool kNeedsAxes = true;
  double frequency_error = 1e-3;  ///< largest median |f_n − true|/true over excited modes
  double contact_error = 1e-4;    ///< largest |x_c − true| [m], where x_c is free
  void visit(OptionVisitor& visitor);
};

/// Outcome of one task: a calibration scored on the truth.
struct BenchmarkOutcome {
  static constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

  /// Why there is no calibration (refused, broken); empty: there is one.
  std::string failure;
  StopReason stop = StopReason::kNotRun;
  std::int64_t evaluations = 0;
  double initial_value = kNan;  ///< of the objective
  double value = kNan;          ///< at the end
  double truth_value = kNan;    ///< at the true model
  double initial_error = kNan;
  /// Median of |f_n − true|/true over the modes that the contact excites.
  double frequency_error = kNan;
  double frequency_rms_error = kNan;  ///< over the same modes
  /// Cramér–Rao bound of frequency_rms_error; NaN without noise.
  double frequency_bound = kNan;
  double contact_error = kNan;  ///< |x_c − true| [m]
  /// Mean correlation of identified and true force over sides and windows.
  double correlation = kNan;
  bool success = false;
  /// Evaluations so far and best value, at the improvements; thinned to 100.
  std::vector<std::pair<std::int64_t, double>> trace;

  /// frequency_rms_error over its bound; NaN without a bound.
  double bound_ratio() const { return frequency_rms_error / frequency_bound; }
  void visit(ResultVisitor& visitor);
};

/// Why a task did not succeed, in words that can be counted; empty where it did.
std::string reason_of(const BenchmarkOutcome& outcome);

/// Calibrates one cell and scores it. Noise, model errors and truth depend on the cell's seed and
/// scene alone: every optimizer sees the same. Throws Interrupted, and InvalidInput where there is
/// no calibration.
BenchmarkOutcome run_benchmark_cell(const CalibrateOptions& options, const SuccessOptions& success,
                                    FrequencyBounds& bounds, const StudyContext& context);

}  // namespace modcal
