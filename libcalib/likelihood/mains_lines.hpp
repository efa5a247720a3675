// Hum of the mains in a record.
#pragma once

#include <vector>

#include "libcalib/likelihood/projected_likelihood.hpp"
#include "libcalib/likelihood/records/whitened_record.hpp"
#include "libcalib/parameters/parameter_table.hpp"

namespace modcal {

/// Lines of the mains as find_mains() has them, of (H_2 Y_1 − H_1 Y_2)/|H|, which holds no force,
/// kNearMode and six bins or more from the string's modes. point: the model as it is expected, its
/// modes to a few per cent.
std::vector<double> mains_lines(const NoisyRecords& records, const ModelPoint& point, double mains);

/// The same by what a fit leaves, e at σ = 0 (projected_likelihood.hpp), in which neither force nor
/// end state are: of a record whose `lines` are empty. point: the model as it is fitted.
std::vector<double> mains_lines(const ProjectedLikelihood& likelihood, const ModelPoint& point,
                                double mains);

/// Whether a fit with these lines leaves what one with the lines of the records does: they are
/// within 0.01/T, of which the steady change of a line leaves (π/100)²/2 rms(τ² − 1/3) = 1.5e-4.
bool same_lines(const std::vector<double>& lines, const NoisyRecords& records);

}  // namespace modcal
