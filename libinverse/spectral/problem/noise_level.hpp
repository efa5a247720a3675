// The noise level that some parameter choices need: an option, or what the data state.
#pragma once

#include "libinverse/spectral/problem/spectral_system.hpp"
#include "libsim/base/options.hpp"

namespace modcal {

/// The option "noise_rms": standard deviation of the noise of one datum [N]; the word "measured"
/// (NaN) stands for the level that comes with the data.
void visit_noise_rms(OptionVisitor& visitor, double& noise_rms);

/// Throws InvalidInput for a level that is negative or infinite.
void require_noise_option(double noise_rms);

/// The option if it is a number, else the data's. Throws InvalidInput where neither is known.
double known_noise_rms(double option, const SpectralData& data);

}  // namespace modcal
