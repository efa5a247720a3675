// Calibration to the bound of the whole record: continuation in σ, the law first, then every
// frequency.
#pragma once

#include <array>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "libcalib/identifiability/continuation_result.hpp"
#include "libcalib/problem/calibration_data.hpp"
#include "libcalib/problem/evaluator.hpp"

namespace modcal {

/// Law (f_0, B, x_c, then one damping factor) through σ ≈ 200, 100, 50, 20 1/s (in proportion to
/// f_0/196 Hz) on records cut to 8/σ, started from the law fitted to the initial frequencies and
/// nine x_c within 0.6 % of L; then σ = 0 with the end state projected out and bins weighted by
/// S/(1 + S). Where χ² contradicts the law: free frequencies through σ ≈ 40, 20, 10, each mode
/// tested against its neighboring minima. Last, free frequencies at σ = 0, each tested again, under
/// the law prior, modes the data do not see tied to the law and modes that leave it set free; where
/// some do or are doubtful, the law is fitted once more without them. The records must begin at
/// rest. Budget, clock and stopping are those of `within`; null: there are none.
ContinuationResult calibrate_by_continuation(const ModelPoint& initial, const CalibrationData& data,
                                             const ContinuationOptions& options,
                                             Evaluator* within = nullptr);

/// Both reactions of the string left to itself after a pluck.
struct PluckRecord {
  CalibrationData data;
  /// Noise standard deviation of each reaction [N]; NaN: estimated from the record.
  std::array<double, 2> noise{std::numeric_limits<double>::quiet_NaN(),
                              std::numeric_limits<double>::quiet_NaN()};
};

/// Every stroke by itself (calibrate_by_continuation), then all at σ = 0 in one likelihood, started
/// from the one χ² contradicts least: frequencies or law shared, the end state of each record its
/// own, and what `per_record` names of x_c, damping and sensors; the rest of these is shared. Modes
/// that no stroke identifies start where the plucks ring. Records are independent, so their
/// informations add. Stated noise levels of `options` hold for all strokes. Throws InvalidInput for
/// no stroke.
ContinuationResult calibrate_records(const ModelPoint& initial,
                                     std::span<const CalibrationData> strokes,
                                     const ContinuationOptions& options,
                                     std::span<const PluckRecord> plucks = {},
                                     Evaluator* within = nullptr);

/// Puts `further` behind `stages`, each name with `prefix` before it and `evaluations` more.
void append_stages(const std::vector<FitStage>& further, const std::string& prefix,
                   std::size_t evaluations, std::vector<FitStage>& stages);

}  // namespace modcal
