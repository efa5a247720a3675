#include "benchmarks/truth/wave_step.hpp"

#include <algorithm>
#include <utility>

// One version of a function for each instruction set, chosen before a sanitizer has begun.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define MODCAL_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#define MODCAL_INLINE __attribute__((always_inline)) inline
#else
#define MODCAL_CLONES
#define MODCAL_INLINE inline
#endif

namespace modcal::truth {
namespace {

// Unrolled by hand: the loop over the points is to be vectorized, and the compiler unrolls too
// late.
template <std::size_t... I>
MODCAL_INLINE double about(const double* taps, const double* at, std::index_sequence<I...>) {
  double sum = taps[0] * at[0];
  ((sum += taps[I + 1] * (at[I + 1] + *(at - (I + 1)))), ...);
  return sum;
}

template <std::size_t P>
MODCAL_INLINE void step_of(const StepArrays& arrays) {
  double elastic[P + 1], losing[P / 2 + 1];
  std::copy_n(arrays.elastic, P + 1, elastic);
  std::copy_n(arrays.losing, P / 2 + 1, losing);
  const double* __restrict y = arrays.y;
  const double* __restrict change = arrays.change;
  double* __restrict new_y = arrays.new_y;
  double* __restrict new_change = arrays.new_change;
  const std::size_t end = 1 + (arrays.end - 1 + kStepBlock - 1) / kStepBlock * kStepBlock;
  for (std::size_t j = 1; j < end; ++j) {
    const double pulled = about(elastic, y + j, std::make_index_sequence<P>());
    const double moved =
        change[j] - (about(losing, change + j, std::make_index_sequence<P / 2>()) + pulled);
    new_change[j] = moved;
    new_y[j] = y[j] + moved;
  }
}

MODCAL_CLONES void step2(const StepArrays& arrays) { step_of<2>(arrays); }
MODCAL_CLONES void step4(const StepArrays& arrays) { step_of<4>(arrays); }
MODCAL_CLONES void step8(const StepArrays& arrays) { step_of<8>(arrays); }

}  // namespace

bool has_step(std::size_t half_width, std::size_t loss_half_width) {
  return (half_width == 2 || half_width == 4 || half_width == 8) &&
         2 * loss_half_width == half_width;
}

void step(std::size_t half_width, const StepArrays& arrays) {
  if (half_width == 8) return step8(arrays);
  if (half_width == 4) return step4(arrays);
  step2(arrays);
}

}  // namespace modcal::truth
