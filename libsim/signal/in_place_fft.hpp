// The same transform in place, for long records: half the memory traffic of RealFft.
#pragma once

#include "libsim/signal/fft.hpp"

namespace modcal {

/// Transform of real sequences of one length in the memory of their spectra, with the convention of
/// RealFft; cheap to copy, safe to use from several threads at once. Bits are the same in every run
/// for arrays from the allocator (aligned to 16 bytes).
class InPlaceFft {
 public:
  /// Plans for `length` ≥ 1 samples.
  explicit InPlaceFft(std::size_t length);

  std::size_t length() const { return length_; }
  std::size_t bins() const { return length_ / 2 + 1; }

  /// The K samples that stand in the memory of K/2 + 1 bins.
  std::span<double> samples_in(std::span<Complex> memory) const {
    return {reinterpret_cast<double*>(memory.data()), length_};
  }
  /// X_k from the samples in the memory.
  void forward(std::span<Complex> memory) const;
  /// K x_j, not scaled by 1/K, from the spectrum in the memory.
  void inverse(std::span<Complex> memory) const;

 private:
  struct Plans;
  std::size_t length_;
  const Plans* plans_;
};

}  // namespace modcal
