// The friction curve as an estimate shows it: force over slip speed, with its spread.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace modcal::observer {

/// Force of the samples whose slip speed lies in one cell.
struct FrictionCell {
  double speed = 0.0;   ///< middle of the cell [m/s]
  double median = 0.0;  ///< of the force against the slip [N]
  double low = 0.0;     ///< 5 % quantile [N]
  double high = 0.0;    ///< 95 % quantile [N]
  std::size_t samples = 0;
};

/// Cells of equal width over the sliding samples, v_c against the bow's direction and |v_c| above 2
/// % of the largest slip speed; cells with fewer than 5 samples are left out. velocity v [m/s] and
/// force f_c [N]: equally many samples, bow velocity v_bow ≠ 0 [m/s], cells ≥ 1. Throws
/// InvalidInput otherwise.
std::vector<FrictionCell> friction_curve(std::span<const double> velocity,
                                         std::span<const double> force, double bow_velocity,
                                         std::size_t cells);

}  // namespace modcal::observer
