// What a number of draws can tell of a root mean square.
#pragma once

#include <cstddef>

namespace modcal {

struct RmsInterval {
  double low = 0.0, high = 0.0;
};

/// Interval that holds σ/r in a share `confidence` of all studies, r being the root mean square of
/// n independent Gaussian errors of mean 0 and deviation σ: n r²/σ² is χ² of n degrees of freedom,
/// low = √(n/χ²_n((1 + confidence)/2)), high = √(n/χ²_n((1 − confidence)/2)) [1]. Throws
/// InvalidInput for n = 0 or a confidence outside (0, 1).
RmsInterval rms_interval(std::size_t n, double confidence = 0.95);

}  // namespace modcal
