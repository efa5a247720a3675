// Standard deviations and correlations in lines of text.
#pragma once

#include <string>
#include <vector>

#include "libcalib/parameters/named_covariance.hpp"

namespace modcal {

/// "m", "(factor)" of the damping; empty where a parameter has no unit.
std::string shown_unit(const std::string& parameter);

/// "correlations f0 +0.31 B -0.72": with the first parameters of `names`, one number each.
std::string correlations_with(const std::vector<std::string>& names,
                              const std::vector<double>& correlations);

/// One line a parameter: name, standard deviation, unit, correlations with those before it.
std::string correlation_lines(const NamedCovariance& covariance);

}  // namespace modcal
