// What is told of a fit of several stages.
#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

namespace modcal {

/// A stage that has ended.
struct FitStage {
  std::string name;             ///< "law, sigma = 100 1/s"
  std::size_t evaluations = 0;  ///< so far, those of all stages before included
  double objective = 0.0;       ///< what it minimized: Σ w|e|² and priors, of its own record
  /// Reduced, of the stage's own record, that of the whole one where bins are weighted; NaN: not
  /// found.
  double chi2 = std::numeric_limits<double>::quiet_NaN();
};

/// Puts `further` behind `stages`, each name with `prefix` before it and `evaluations` more.
void append_stages(const std::vector<FitStage>& further, const std::string& prefix,
                   std::size_t evaluations, std::vector<FitStage>& stages);

}  // namespace modcal
