// Weights of the bins by what they hold besides noise.
#pragma once

#include <vector>

#include "libcalib/likelihood/projected_likelihood.hpp"

namespace modcal {

/// w = S/(1 + S) for the bins of `target`: S = |h|² max(P, 0), the force's power P smoothed over 31
/// bins of the lightly damped record (σ = `sigma`), in which no end state confuses the force:
/// P = Σ(|f̂|² − 1)/Σ|h|². Under them the score's variance is least where the force is unknown
/// (Neyman and Scott, 1948).
std::vector<double> signal_weights(const NoisyRecords& records, double sigma, double highest,
                                   const ProjectedLikelihood& target, const ModelPoint& point);

}  // namespace modcal
