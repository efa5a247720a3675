// Kind "benchmark": calibrations over objectives, optimizers and data, scored on the truth.
#pragma once

#include "experiments/kinds/benchmark/benchmark_bound.hpp"
#include "experiments/kinds/benchmark/benchmark_outcome.hpp"
#include "experiments/kinds/calibrate/calibrate_study.hpp"

namespace modcal {

/// When a calibration counts as successful.
struct SuccessOptions {
  double frequency_error = 1e-3;  ///< largest median |f_n − true|/true over excited modes
  double contact_error = 1e-4;    ///< largest |x_c − true| [m], where x_c is free
  void visit(OptionVisitor& visitor);
};

/// Calibrates one cell and scores it; a failure is an outcome. Noise, model errors and truth depend
/// on the cell's seed and scene alone: every optimizer sees the same. Throws Interrupted.
BenchmarkOutcome run_benchmark_cell(const CalibrateOptions& options, const SuccessOptions& success,
                                    FrequencyBounds& bounds, const StudyContext& context);

}  // namespace modcal
