// What is told of a fit of several stages, and how it is ended early.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <string>

namespace modcal {

/// A stage that has ended.
struct FitStage {
  std::string name;             ///< "law, sigma = 100"
  std::size_t evaluations = 0;  ///< so far, those of all stages before included
  double objective = 0.0;       ///< what it minimized, priors included
  /// Reduced, of the stage's own record; NaN where its bins are weighted.
  double chi2 = std::numeric_limits<double>::quiet_NaN();
};

/// Called before every evaluation; what it throws (Interrupted, say) ends the fit and comes out of
/// it. Empty: nobody can ask.
using FitPoll = std::function<void()>;

}  // namespace modcal
