#include "libinverse/spectral/problem/noise_level.hpp"

#include <cmath>

#include "libsim/base/error.hpp"

namespace modcal {

void visit_noise_rms(OptionVisitor& visitor, double& noise_rms) {
  visitor.number({.key = "noise_rms",
                  .meaning = "standard deviation of the noise of one sample; measured: the level "
                             "that comes with the data",
                  .unit = "N",
                  .range = Range::non_negative(),
                  .word = "measured"},
                 noise_rms);
}

void require_noise_option(double noise_rms) {
  MODCAL_REQUIRE(std::isnan(noise_rms) || (noise_rms >= 0.0 && std::isfinite(noise_rms)),
                 "standard deviation {:g} of the noise must be a finite number >= 0", noise_rms);
}

double known_noise_rms(double option, const SpectralData& data) {
  const double noise = std::isnan(option) ? data.noise_rms : option;
  MODCAL_REQUIRE(noise >= 0.0 && std::isfinite(noise),
                 "this parameter choice needs the noise level and the data do not state it: set "
                 "noise_rms, or choose a rule that does without");
  return noise;
}

}  // namespace modcal
