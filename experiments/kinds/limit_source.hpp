// Experiments whose calibration has a limit that `modcal limit` can state.
#pragma once

#include <string>

#include "experiments/study/observation.hpp"

namespace modcal {

struct LimitQuestion {
  ObservationOptions observation;
  double noise_level = 0.01;
  double highest_frequency = 0.0;  ///< [Hz]; NaN: automatic
  double law_width = 2e-3;         ///< τ of the prior of f_n about the law
};

class LimitSource {
 public:
  virtual ~LimitSource() = default;
  virtual LimitQuestion limit_question() const = 0;
};

/// The standard deviation to expect of every parameter, a verdict for each mode, and contact points
/// that remove blind modes. Throws InvalidInput for a record: the truth has to be simulated.
std::string limit_text(const LimitQuestion& question, TruthCache& truths);

}  // namespace modcal
