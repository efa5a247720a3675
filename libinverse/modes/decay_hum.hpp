// Hum of the mains in a free decay.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "libinverse/modes/decay_record.hpp"

namespace modcal {

/// Lines of the mains below half the rate [Hz], as find_mains() finds them in the power of the
/// channels. poles: of the decay, near which lines are not looked for, but for those that do not
/// decay, as far as they tell, apart from the multiples of the fundamental [Hz]; NaN: there is none.
std::vector<double> hum_in(const DecayRecord& decay, std::span<const DecayMode> poles,
                           double fundamental);

/// The decay less the lines that stand apart from its poles: amplitude, phase and a steady change
/// of both fit it best under the window that keeps the poles apart from them.
DecayRecord without_hum(DecayRecord decay, std::span<const double> lines,
                        std::span<const DecayMode> poles, double fundamental);

/// Whether the record, of this duration [s], does not tell the mode from one of the lines: within
/// 1/T of it, it decays no more than its deviation and the wandering of the mains let a line seem to.
bool is_line(const DecayMode& mode, std::span<const double> lines, double duration);

/// Columns of every line beside others of a linear fit: cosine and sine, steady and growing along
/// the decay, since the mains wander and their frequency is known to a part of 1/T.
Eigen::MatrixXd hum_columns(std::size_t samples, double rate, std::span<const double> lines);

}  // namespace modcal
