#include "libcalib/identifiability/rms_interval.hpp"

#include <gsl/gsl_cdf.h>

#include <cmath>

#include "libsim/base/error.hpp"

namespace modcal {

RmsInterval rms_interval(std::size_t n, double confidence) {
  MODCAL_REQUIRE(n > 0, "an interval needs at least one draw, not {}", n);
  MODCAL_REQUIRE(confidence > 0.0 && confidence < 1.0, "confidence {:g} must lie in (0, 1)",
                 confidence);
  const auto count = static_cast<double>(n);
  const auto edge = [&](double share) {
    return std::sqrt(count / gsl_cdf_chisq_Pinv(share, count));
  };
  return {edge(0.5 + 0.5 * confidence), edge(0.5 - 0.5 * confidence)};
}

}  // namespace modcal
