#include <algorithm>
#include <cmath>
#include <numbers>

#include "libcalib/optimizers/staged/continuation.hpp"
#include "libsim/base/error.hpp"

namespace modcal {

double likelihood_band(const ModelPoint& point, double highest_frequency, double sample_rate) {
  std::vector<double> omega = point.basis.omega;
  std::sort(omega.begin(), omega.end());
  const double highest = std::isnan(highest_frequency) ? 1.05 * omega.back()
                                                       : 2.0 * std::numbers::pi * highest_frequency;
  const std::size_t needed = std::min<std::size_t>(2, omega.size());
  MODCAL_REQUIRE(omega[needed - 1] < highest,
                 "highest_frequency {:g} Hz: below it lie fewer than the {} modes that tell f0 and "
                 "B; state automatic, or more than {:g} Hz",
                 highest_frequency, needed, 0.5 * omega[needed - 1] / std::numbers::pi);
  // Above 0.4 f_s the aliases of the force's jumps are no longer small.
  return std::min(highest, 0.8 * std::numbers::pi * sample_rate);
}

}  // namespace modcal
