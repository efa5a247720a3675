// A mode of a fit as two.
#pragma once

#include <cstddef>
#include <vector>

#include "libinverse/modes/damped_sinusoid_fit.hpp"

namespace modcal {

struct SecondPole {
  std::vector<std::size_t> replaced;  ///< the mode and those near it
  std::vector<DecayPole> poles;       ///< in their place, one more; none where χ² does not fall
  double work = 0.0;                  ///< of the fits (work_of)
};

/// The poles of a mode as two and of modes nearer to it than `reach` [Hz], by a fit of these alone
/// to what they and the residual are: all others stay as they are, so that it costs what three
/// poles do. The second starts as far from the mode as it is wide, to either side, or decays faster
/// or slower; the best is taken by which χ² falls by more than `least`.
SecondPole fit_as_two(const DampedSinusoidFit& fit, std::size_t mode, double sample_rate,
                      double reach, double least, const DampedSinusoidOptions& options);

}  // namespace modcal
