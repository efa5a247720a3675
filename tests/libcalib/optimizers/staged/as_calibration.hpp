// What a fit of the joint likelihood is told, in the form of a calibration.
#pragma once

#include "libcalib/calibration.hpp"
#include "libcalib/objectives/joint_likelihood.hpp"
#include "libcalib/optimizers/staged/continuation.hpp"
#include "libcalib/optimizers/staged/staged.hpp"

namespace modcal {

inline CalibrationOptions as_calibration(const ContinuationOptions& fit) {
  CalibrationOptions options = calibration_to_the_bound();
  options.parameters.frequencies = fit.frequencies ? "all" : "none";
  options.parameters.unknowns = fit.unknowns;
  options.parameters.law_width = fit.law_width;
  options.objective = Choice<Objective>::of<JointLikelihood>(
      "joint_likelihood", {.highest_frequency = fit.highest_frequency,
                           .left_noise = fit.left_noise,
                           .right_noise = fit.right_noise});
  options.optimizer =
      Choice<Optimizer>::of<Staged>("staged", {.schedule = {.restarts = fit.restarts}});
  return options;
}

inline std::vector<CalibrationRecord> as_records(const std::vector<CalibrationData>& strokes) {
  std::vector<CalibrationRecord> records;
  for (const CalibrationData& stroke : strokes) records.push_back({.data = stroke});
  return records;
}

}  // namespace modcal
