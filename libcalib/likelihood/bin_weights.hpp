// Weights of the bins by what they hold besides noise.
#pragma once

#include <vector>

#include "libcalib/likelihood/projected_likelihood.hpp"

namespace modcal {

/// w = S/(1 + S) for the bins of `likelihood` [1]. S is what the record adds to a bin's share of
/// the information over what noise alone adds,
///
///     q_k = Re J⊥_k A⁻¹ J⊥_kᴴ,  A = Re J⊥ᴴJ⊥,  S_k = |h_k|² Σ (q/q̄_noise − 1) / Σ |h|²,
///
/// the sums over the five bins about a line and over 121 bins between lines, not below 0. Without
/// an end state S is |h|²|F|²; where the end state takes what the force left in a bin, S is less.
/// Under these weights the score's variance is least where the force is unknown: Σ w J̄e, with w J
/// the force's posterior mean in the place of J (Neyman and Scott, 1948; Godambe, 1960). Throws
/// InvalidInput for a likelihood that has weights already.
std::vector<double> information_weights(const ProjectedLikelihood& likelihood,
                                        const ModelPoint& point, const LikelihoodColumns& columns);

/// The weights of least variance for clean data, w_k = q_k/(q_k + q̄_noise): what
/// information_weights() would be if it knew every bin's share of the information.
std::vector<double> best_weights(const ProjectedLikelihood& clean, const ModelPoint& point,
                                 const LikelihoodColumns& columns);

/// S/(1 + S) of the excess q/q̄ − 1 of every bin under its gain |h|²; arrays of one length.
std::vector<double> weights_of_excess(const std::vector<double>& excess,
                                      const std::vector<double>& gain);

}  // namespace modcal
