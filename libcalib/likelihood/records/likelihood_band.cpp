#include "libcalib/likelihood/records/likelihood_band.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "libsim/base/error.hpp"

namespace modcal {

namespace {

// That the first n modes describe.
double band_of_first(const ModalBasis& basis, std::size_t n) {
  const double top = basis.frequency(n - 1);
  // A start may be 4 % too high, and mode n + 1 is to stay outside.
  return 0.96 * (n > 1 ? 0.5 * (top + basis.frequency(n - 2)) : top);
}

}  // namespace

double band_of_modes(const ModalBasis& basis) { return band_of_first(basis, basis.size()); }

std::size_t ringing_modes(const ModalBasis& basis, double highest) {
  std::size_t count = basis.size();
  while (count > 2 && band_of_first(basis, count - 1) >= highest) --count;
  return count;
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
