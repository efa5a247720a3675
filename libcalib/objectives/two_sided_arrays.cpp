#include "libcalib/objectives/two_sided_arrays.hpp"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace modcal {

void add_up_terms_in_parallel(std::span<const TwoSidedTerm> terms, double spacing,
                              const TwoSidedSums& sums) {
  // About 100 µs of work for 50 modes; a multiple of kBandLanes.
  constexpr std::size_t kBlock = 1024;
  const std::size_t blocks = (sums.bins + kBlock - 1) / kBlock;
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t block) {
    const std::size_t begin = block * kBlock;
    TwoSidedSums part = sums;
    part.first_bin += begin;
    part.bins = std::min(kBlock, sums.bins - begin);
    for (std::size_t r = 0; r < 2; ++r) {
      part.real[r] += begin;
      part.imag[r] += begin;
    }
    add_up_terms(terms, spacing, part);
  });
}

}  // namespace modcal
