// Noise of a measured force, told by what it makes alike in all sensors.
#pragma once

#include "libinverse/structure/strikes/pole_search.hpp"
#include "libinverse/structure/strikes/strike_fit.hpp"
#include "libinverse/structure/strikes/strike_weights.hpp"

namespace modcal {

/// White noise of the force, of variance v [N²]: sensors leave r_k = −H_k N, of which the products
/// of two, Σ_m Re(conj(a_k) a_l), a_k = conj(H_k) r_k/σ_k², are v times what noise of 1 N leaves
/// beside the unknowns of the fit, by kForceNoiseDraws of it. Where they are less than three
/// deviations of what chance makes of residuals that are not alike, as always of one sensor, it is
/// what the force reads while nothing strikes (quiet_level), as far as these allow it. records:
/// with the forces; fits, slopes: of the sensors at the model's poles, K; weights: by strike.
ForceNoise force_noise_of(std::span<const StructureRecord> records,
                          std::span<const FittedStrike> strikes,
                          std::span<const BinWeights> weights, const ModalModel& model,
                          std::span<const SensorFit> fits, std::span<const Eigen::MatrixXd> slopes);

/// Deviation of a force where it is quiet [N]: the lower quartile of those of kQuietParts of its
/// record. 0 where that is above kQuietShare of its peak, as of a force that acts all the time.
double quiet_level(std::span<const double> force);

}  // namespace modcal
