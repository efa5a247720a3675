// Discrete Fourier transform of real sequences: the only door to FFTW.
//
// Convention of the whole project (paper's sign): X(ω) = ∫ x(t) exp(−iωt) dt. The discrete spectrum
// is the unscaled sum X_k = Σ_j x_j exp(−2πi jk/K), k = 0 … K/2, at ω_k = 2π k f_s/K; multiply by
// 1/f_s for an estimate of X(ω_k).
#pragma once

#include <complex>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace modcal {

using Complex = std::complex<double>;

struct FftPlans;

/// Transform pair for one length; cheap to copy, safe to use from several threads at once.
class RealFft {
 public:
  /// Plans for `length` ≥ 1 samples; plans are shared between objects of one length. The planner
  /// estimates (FFTW_ESTIMATE), so that every run has the same bits.
  explicit RealFft(std::size_t length);

  std::size_t length() const { return length_; }
  std::size_t bins() const { return length_ / 2 + 1; }

  /// X_k = Σ_j x_j exp(−2πi jk/K). samples: K, spectrum: K/2 + 1.
  void forward(std::span<const double> samples, std::span<Complex> spectrum) const;
  /// x_j = (1/K) Σ_k X_k exp(+2πi jk/K), the spectrum being that of a real sequence (the imaginary
  /// parts of X_0 and, for even K, of X_{K/2} are ignored). Overwrites `spectrum`.
  void inverse(std::span<Complex> spectrum, std::span<double> samples) const;

  std::vector<Complex> forward(std::span<const double> samples) const;
  std::vector<double> inverse(std::vector<Complex> spectrum) const;

 private:
  std::size_t length_;
  const FftPlans* plans_;
};

/// Multiplicity of bin k of a real sequence's half spectrum: 1 for k = 0 and (even K) k = K/2, else
/// 2; Parseval: Σ_j x_j² = (1/K) Σ_k multiplicity_k |X_k|².
double bin_multiplicity(std::size_t k, std::size_t length);

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
  std::size_t length_;
  const FftPlans *aligned_, *unaligned_;  // to 16 bytes or not
};

// Spectrum in which neither lines nor the ends of a record hide what is between them.

/// Σ_j w_j (x_j − x̄) exp(−2πi jk/K)/√(Σ w²) under the Hann window w_j = ½ − ½ cos(2πj/K) in the
/// unit of the samples: white noise of variance σ² has E|X_k|² = σ². K ≥ 2 samples; K/2 + 1 bins.
/// first, last: of the samples from `first` to before `last` ≥ first + 2, all others 0 in the
/// transform of all K.
std::vector<Complex> hann_spectrum(std::span<const double> samples, std::size_t first = 0,
                                   std::size_t last = std::numeric_limits<std::size_t>::max());

}  // namespace modcal
