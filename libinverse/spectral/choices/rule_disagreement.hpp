// Whether other rules would have chosen about the same parameter.
#pragma once

#include <cstddef>
#include <string>

#include "libinverse/spectral/choices/parameter_choice.hpp"

namespace modcal {

/// A sentence that names the rules which would have chosen, inside the same range, a parameter more
/// than a factor of 10 from the chosen one, with their parameters; empty where none would, or where
/// nothing was chosen. Asked are the rules that the traced curve answers without another pass over
/// the data: generalized cross validation, the minimal product and, where the noise level is known
/// (not NaN), the discrepancy principle. `rows`: real numbers in the data.
std::string disagreement_of(const ChosenParameter& choice, std::size_t rows, double noise_rms);

}  // namespace modcal
