// What a calibration by continuation says of its own result.
#pragma once

#include <string>

#include "libcalib/optimizers/staged/continuation.hpp"

namespace modcal {

/// What contradicts a result that is not right: χ², the priors stated, or both; else empty.
std::string contradiction(const ContinuationResult& found);

}  // namespace modcal
