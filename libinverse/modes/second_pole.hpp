// One more pole beside a mode of a fit.
#pragma once

#include <complex>
#include <cstddef>
#include <optional>
#include <vector>

#include "libinverse/modes/damped_sinusoid_fit.hpp"

namespace modcal {

struct SecondPole {
  std::vector<std::size_t> replaced;  ///< the mode and those near it
  std::vector<DecayPole> poles;       ///< in their place, one more; none where χ² does not fall
  double work = 0.0;                  ///< of the fits (work_of)
};

/// The poles of a mode and of those nearer to it than `reach` [Hz] with one more, by a fit of these
/// alone to what they and the residual are: all others stay as they are, so that it costs what
/// three poles do. The one more starts at `stated`, if it is, as far from the mode as that is wide,
/// to either side, or decays faster or slower; the best is taken by which χ² falls by more than
/// `least`.
SecondPole fit_one_more(const DampedSinusoidFit& fit, std::size_t mode, double sample_rate,
                        double reach, double least, const DampedSinusoidOptions& options,
                        const std::optional<DecayPole>& stated = {});

/// What a fit leaves, with some of its modes.
DecayRecord alone(const DampedSinusoidFit& fit, const std::vector<std::size_t>& modes,
                  double sample_rate);

}  // namespace modcal
