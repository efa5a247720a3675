// Hum of the mains in a record.
#pragma once

#include <vector>

#include "libcalib/likelihood/projected_likelihood.hpp"
#include "libcalib/likelihood/records/whitened_record.hpp"
#include "libcalib/parameters/parameter_table.hpp"

namespace modcal {

/// Lines h F, h = 1 … H, of the mains [Hz]: 8 of them, or as many as stand out, at most 20. F is
/// stated to 0.5 % (`mains` > 0), or looked for so near 50 and 60 Hz (`mains` NaN): it is there if
/// its first or second harmonic stands out of (H_2 Y_1 − H_1 Y_2)/|H|, which holds no force, and F
/// maximizes the power of all that do where the first one says, under a Blackman-Harris window
/// (Harris, 1978). To stand out is to have kLineRatio times the median power of the bins about it,
/// kNearMode and six bins or more from the string's modes. mains = 0, or a record of less than 16
/// periods: none. point: the model as it is expected, its modes to a few per cent.
std::vector<double> mains_lines(const NoisyRecords& records, const ModelPoint& point, double mains);

/// The same by what a fit leaves, e at σ = 0 (projected_likelihood.hpp), in which neither force nor
/// end state are: of a record whose `lines` are empty. point: the model as it is fitted.
std::vector<double> mains_lines(const ProjectedLikelihood& likelihood, const ModelPoint& point,
                                double mains);

/// Whether a fit with these lines leaves what one with the lines of the records does: they are
/// within 0.01/T, of which the steady change of a line leaves (π/100)²/2 rms(τ² − 1/3) = 1.5e-4.
bool same_lines(const std::vector<double>& lines, const NoisyRecords& records);

}  // namespace modcal
