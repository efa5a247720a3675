// Storage for sums over modes at both ends.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "libcalib/problem/calibration_data.hpp"
#include "libcalib/objectives/spectral_peak_kernel.hpp"

namespace modcal {

/// Arrays behind TwoSidedSums, padded for the kernels.
class TwoSidedArrays {
 public:
  /// View of the arrays for these bins; they keep their storage from call to call.
  TwoSidedSums view(const BinRange& bins) {
    const std::size_t size = bins.size() + kBandLanes;
    TwoSidedSums sums{.first_bin = bins.first, .bins = bins.size()};
    for (std::size_t r = 0; r < 2; ++r) {
      if (real_[r].size() < size) real_[r].resize(size);
      if (imag_[r].size() < size) imag_[r].resize(size);
      sums.real[r] = real_[r].data();
      sums.imag[r] = imag_[r].data();
    }
    return sums;
  }

 private:
  std::array<std::vector<double>, 2> real_;
  std::array<std::vector<double>, 2> imag_;
};

/// add_up_terms() in blocks of bins on all cores; the same bits for any number of them.
void add_up_terms_in_parallel(std::span<const TwoSidedTerm> terms, double spacing,
                              const TwoSidedSums& sums);

}  // namespace modcal
