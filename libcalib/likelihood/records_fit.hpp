// One fit to several records of one string: strokes, contact points.
#pragma once

#include <span>
#include <vector>

#include "libcalib/likelihood/continuation.hpp"

namespace modcal {

struct RecordsFit {
  ModelPoint model;              ///< shared; the contact of the first record
  std::vector<double> contacts;  ///< x_c of every record [m]
  std::vector<double> contact_deviations;
  /// f_0 [Hz] and B where the law alone is fitted, and their standard deviations.
  double fundamental = 0.0, inharmonicity = 0.0;
  double fundamental_deviation = 0.0, inharmonicity_deviation = 0.0;
  /// Relative standard deviations of f_n, where every frequency is free.
  std::vector<double> frequency_deviations;
  std::array<double, 3> sensor_deviation{};  ///< as in ContinuationResult
  double damping = 1.0;                      ///< as in ContinuationResult
  double damping_deviation = 0.0;
  double chi2 = 0.0;  ///< reduced, of all records
  double chi2_deviation = 0.0;
  bool right = false;                      ///< χ² < 1 + 3 sd
  std::vector<ContinuationResult> single;  ///< every record by itself
};

/// Every record by itself (calibrate_by_continuation), then all at σ = 0 in one likelihood, started
/// from the one χ² contradicts least: frequencies or law, damping and sensors shared, x_c and the
/// end state of each record its own. Records are independent, so their informations add. Stated
/// noise levels hold for all records. Throws InvalidInput for no record.
RecordsFit calibrate_records(const ModelPoint& initial, std::span<const CalibrationData> records,
                             const ContinuationOptions& options);

/// The fit in the form of that of one record: model, χ², what is shared and its deviations, the
/// first record's contact; a mode's verdict is that of the record by itself that sees it best.
/// Where every frequency is free, `law` stays that of the first record.
ContinuationResult as_continuation(const RecordsFit& fit);

}  // namespace modcal
