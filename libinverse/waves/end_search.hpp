// The search for the string whose ends a record obeys.
#pragma once

#include <vector>

#include "libinverse/waves/end_misfits.hpp"
#include "libinverse/waves/end_residual.hpp"
#include "libsim/signal/fft.hpp"

namespace modcal {

/// Spectra of the Hann-windowed reactions, white noise of 1 N being 1 in each bin.
struct EndSpectra {
  explicit EndSpectra(const EndRecord& record);
  double sample_rate, width;  ///< of the record and of a bin [Hz]
  std::array<double, 2> variance;
  std::vector<Complex> left, right;
};

/// Powers of these at some bins.
struct EndBins {
  std::vector<double> frequency;
  std::vector<double> left, right, product;  ///< |R₁|², |R₂|², Re R₁ R₂*
  std::array<double, 2> variance{};
  std::array<double, 2> peak_over_noise{};
  double error = 0.0;  ///< of the relation, relative

  std::size_t size() const { return frequency.size(); }
  /// 1 + |e|²/v of e = a R₁ ∓ b R₂.
  std::array<double, 2> misfits(std::size_t i, double a, double b) const;
};

/// Bins up to `top` f₀ that stand above the noise: the others tell of no relation.
EndBins bins_of(const EndSpectra& spectra, double fundamental, double top);

/// The same for the kernel.
EndPowers powers_of(const EndBins& bins);

/// Steps about a string, so many to either side.
struct StringGrid {
  struct Steps {
    double size = 0.0;
    int count = 0;
    Steps halved() const { return {0.5 * size, count > 0 ? 1 : 0}; }
  };
  Steps fundamental;    ///< of f₀ [1]
  Steps contact;        ///< of x_c/L [1]
  Steps inharmonicity;  ///< of B [1]
  StringGrid halved() const {
    return {fundamental.halved(), contact.halved(), inharmonicity.halved()};
  }
};

/// The least misfits of the strings of the grid; `best` becomes the one that serves best as stated.
StringMisfits least_misfits(const EndBins& bins, const StringGrid& grid, StatedString& best);
/// Of the string as stated alone, the first of these.
double least_misfit(const EndBins& bins, const StringGrid& grid, StatedString& best);

}  // namespace modcal
