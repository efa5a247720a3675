// Kernel of the modal sum: no allocation, instruction set chosen at run time.
#pragma once

#include "libsim/base/aligned_vector.hpp"
#include "libsim/model/modal_model.hpp"

namespace modcal {

/// Rows of SplitSpectra are padded to a multiple of this many bins.
inline constexpr std::size_t kBinLanes = kVectorPadding;

/// One sum over modes: N real numerators, and where its real and imaginary part go.
struct ModalSum {
  const double* numerator = nullptr;
  double* real = nullptr;
  double* imag = nullptr;
};

/// Σ_n numerator_n/D_n(s_k) of several sums over the bins of the grid. Three sums at a time share
/// their denominators, and four terms a division. Every bin is computed by itself: splitting the
/// range at multiples of kBinLanes changes no bit.
void add_up_modes(std::span<const ModalPole> poles, std::span<const ModalSum> sums,
                  const FrequencyGrid& grid, const BinRange& bins);

}  // namespace modcal
