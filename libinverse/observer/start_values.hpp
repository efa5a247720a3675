// Where the fit of the observer begins: what a linear estimate of the contact shows.
#pragma once

#include <vector>

#include "libinverse/observer/observed_record.hpp"
#include "libinverse/observer/parameter_space.hpp"

namespace modcal::observer {

/// Linear estimate of the motion at the contact from both reactions.
struct LinearEstimate {
  std::vector<double> force;     ///< [N]
  std::vector<double> velocity;  ///< [m/s]
  /// Standard deviation of force [N] under the sensors' noise; what the band limit cuts off is not
  /// in it.
  std::vector<double> force_deviation;
};

/// Joint estimate on the contour s = 2/T + iω, F = Σ_r H̄_r R_r/s_r² ÷ Σ_r |H_r|²/s_r² up to the
/// highest mode and 0 above, the offsets taken off first. Weighting by e^{−2t/T} holds what the
/// transform wraps down to e^{−2}.
LinearEstimate linear_estimate(const ObservedRecord& record);

/// What a linear estimate shows of bow and friction.
struct ContactPicture {
  double bow_velocity = 0.0;   ///< mode of the histogram of v after the transient [m/s]
  double slip_speed = 0.0;     ///< v_bow minus the 1 % quantile of v [m/s]
  double dynamic_force = 0.0;  ///< median of f while it slides fast [N]
  double static_force = 0.0;   ///< 99.5 % quantile of f, at least 1.3 F_D [N]
};

/// Direction of the bow: +1 or −1, the sign of the most frequent velocity.
double bow_direction(const LinearEstimate& estimate);

/// For a bow that moves in the positive direction. Throws InvalidInput where the estimate shows no
/// stick and slip.
ContactPicture picture_of(const LinearEstimate& estimate);

}  // namespace modcal::observer
