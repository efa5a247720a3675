// Test of every mode against the minima beside the one it was found in.
#pragma once

#include <vector>

#include "libcalib/likelihood/projected_likelihood.hpp"
#include "libcalib/parameters/string_unknowns.hpp"

namespace modcal {

/// Another place within ±0.6 % for one mode.
struct Neighbor {
  double shift = 0.0;  ///< of δ_n; 0: there is none
  double gain = 0.0;   ///< Σ|e|² + prior here less that there
  /// Within three standard deviations of as good: the bins do not tell the two apart.
  bool is_rival() const { return shift != 0.0 && gain > -4.5; }
};

/// For each mode the best place beyond the minimum that it is in, or in it by more than 9, from the
/// 256 bins about it, one mode at a time: its own end state is free at each place, the other modes,
/// x_c, damping and sensors are held. Places are half a width of its damped resonance apart.
std::vector<Neighbor> neighbors(const ProjectedLikelihood& likelihood,
                                const StringUnknowns& unknowns, const QuadraticPrior& prior,
                                const Eigen::VectorXd& theta);

/// Moves the modes whose neighboring minimum is better by more than 9 in Σ|e|² + prior (more than
/// four standard deviations), and by more than those of the two modes on either side. Returns how
/// many were moved.
std::size_t leave_false_minima(const std::vector<Neighbor>& neighbors, Eigen::VectorXd& theta);

}  // namespace modcal
