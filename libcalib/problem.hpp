// One estimation problem.
//
// Frequency refinement is a pluggable objective (spectral-peak integral, two-sided force mismatch,
// contact-location error, joint likelihood, innovation misfit) over modal frequencies, B and x_c,
// solved by grid search, NLopt, Ceres or GSL, with the inverse solver as the inner kernel and the
// simulator supplying synthetic truth.
#pragma once

#include <memory>
#include <vector>

#include "libcalib/objective.hpp"
#include "libcalib/parameters/parameter_options.hpp"
#include "libcalib/problem/calibration_data.hpp"

namespace modcal {

/// Model + records + parameters + objective: all that a calibration is, save how it is searched.
struct Problem {
  ModelPoint model;                        ///< initial
  std::vector<CalibrationRecord> records;  ///< n >= 1, strokes before plucks
  ParameterOptions parameters;             ///< what is free, fixed or known beforehand
  std::shared_ptr<const Objective> objective;
  SupportOptions support;  ///< what the ends feel besides the stated modes
  /// Modes with |φ_n(x_c)| below this are blind: nothing in the reactions tells their frequency
  /// [1].
  double excitation_threshold = 0.1;
};

}  // namespace modcal
