// The inner loop of the scheme.
#pragma once

#include <cstddef>
#include <span>

namespace modcal::truth {

/// Points are done in blocks of this many.
inline constexpr std::size_t kStepBlock = 8;

/// d' = d − C d − E y and y' = y + d' at points 1 … end − 1 and on to the end of the last block.
/// The arrays reach P points beyond both; none overlap.
struct StepArrays {
  const double* elastic;  ///< E: taps 0 … P
  const double* losing;   ///< C: taps 0 … P/2
  const double* y;
  const double* change;
  double* new_y;
  double* new_change;
  std::size_t end;
};

/// Whether there is a loop for these half-widths: (2, 1), (4, 2), (8, 4).
bool has_step(std::size_t half_width, std::size_t loss_half_width);
/// One step. Instruction sets differ by rounding: some fuse products and sums.
void step(std::size_t half_width, const StepArrays& arrays);

/// The stencil of these taps about a point.
inline double value_at(std::span<const double> taps, const double* at) {
  double sum = taps[0] * at[0];
  for (std::size_t i = 1; i < taps.size(); ++i) {
    sum += taps[i] * (at[i] + *(at - i));
  }
  return sum;
}

}  // namespace modcal::truth
