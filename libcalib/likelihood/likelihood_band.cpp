#include "libcalib/likelihood/likelihood_band.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "libsim/base/error.hpp"

namespace modcal {

double band_of_modes(const ModalBasis& basis) {
  const std::size_t n = basis.size();
  const double top = basis.frequency(n - 1);
  // A start may be 4 % too high, and mode N + 1 is to stay outside.
  return 0.96 * (n > 1 ? 0.5 * (top + basis.frequency(n - 2)) : top);
}

double likelihood_band(const ModelPoint& point, double highest_frequency, double sample_rate) {
  std::vector<double> omega = point.basis.omega;
  std::sort(omega.begin(), omega.end());
  double highest = 2.0 * std::numbers::pi * highest_frequency;
  if (std::isnan(highest_frequency)) {
    highest =
        point.higher ? 2.0 * std::numbers::pi * band_of_modes(point.basis) : 1.05 * omega.back();
  }
  const std::size_t needed = std::min<std::size_t>(2, omega.size());
  MODCAL_REQUIRE(omega[needed - 1] < highest,
                 "highest_frequency {:g} Hz: below it lie fewer than the {} modes that tell f0 and "
                 "B; state automatic, or more than {:g} Hz",
                 highest_frequency, needed, 0.5 * omega[needed - 1] / std::numbers::pi);
  // Above 0.4 f_s the aliases of the force's jumps are no longer small.
  return std::min(highest, 0.8 * std::numbers::pi * sample_rate);
}

}  // namespace modcal
