// Experiments whose calibration has a limit that `modcal limit` can state.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "experiments/study/observation.hpp"
#include "libcalib/calibration.hpp"
#include "libcalib/identifiability/expected_limit.hpp"

namespace modcal {

/// What is simulated and what a calibration of it frees.
struct LimitQuestion {
  static constexpr double kLawWidth = 2e-3;  ///< τ where it is to be estimated

  ObservationOptions observation;
  double noise_level = 0.01;               ///< of every stroke
  std::vector<double> further_contacts;    ///< x_c of further strokes of the scene [m]
  std::vector<ObservationOptions> plucks;  ///< with noise levels of their own
  double highest_frequency = std::numeric_limits<double>::quiet_NaN();  ///< [Hz]; NaN: automatic
  double law_width = kLawWidth;  ///< τ of the prior of f_n about the law
  UnknownsOptions unknowns;

  /// Takes the band, τ and the unknowns of a calibration.
  void calibrate_by(const CalibrationOptions& calibration);
};

class LimitSource {
 public:
  virtual ~LimitSource() = default;
  virtual LimitQuestion limit_question() const = 0;
};

/// The records of the question without noise, simulated through the cache, and the bounds. Throws
/// InvalidInput for a record: the truth has to be simulated. `outputs`: what the first stroke is
/// simulated with beside its reactions, where somebody else asks for them too.
LimitCase limit_case(const LimitQuestion& question, TruthCache& truths, OutputRequest outputs = {});

/// The standard deviation to expect of every parameter, a verdict for each mode, and contact points
/// that remove blind modes. Throws InvalidInput for a record: the truth has to be simulated.
std::string limit_text(const LimitQuestion& question, TruthCache& truths);

}  // namespace modcal
