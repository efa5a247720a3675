// Noise of the two sensors over frequency: their spectra and what they have in common.
#pragma once

#include <complex>
#include <vector>

namespace modcal {

/// Of the noise n_r of the whitened reactions in one bin.
struct NoiseCovariance {
  double left = 1.0, right = 1.0;  ///< E|n_1|², E|n_2|²
  double mixed = 0.0;              ///< E n_1 conj(n_2), real: no delay is between them

  double determinant() const { return left * right - mixed * mixed; }
  /// E|h_2n_1 − h_1n_2|², the residual's variance.
  double of_residual(std::complex<double> h1, std::complex<double> h2) const {
    return right * std::norm(h1) + left * std::norm(h2) -
           2.0 * mixed * std::real(std::conj(h1) * h2);
  }
};
/// What the records hold besides h_rF̂ where the whitened residual is e:
/// C (conj h_2, −conj h_1)ᵀ e/√of_residual, C the covariance.
struct NoisePair {
  std::complex<double> left, right;
};
NoisePair noise_of_residual(const NoiseCovariance& noise, std::complex<double> h1,
                            std::complex<double> h2, std::complex<double> e);

/// C over s_r² at frequencies, linear in ln f between them, constant beyond. No knot: white, as
/// strong as s_r, independent.
struct NoiseSpectrum {
  struct Knot {
    double frequency = 0.0;  ///< > 0, rising [Hz]
    NoiseCovariance noise;   ///< positive definite, as it then is between knots, too
  };
  std::vector<Knot> knots;

  bool white() const { return knots.empty(); }
  NoiseCovariance at(double frequency) const;  ///< [Hz]
  /// Anywhere by more than this share of a sensor's power.
  bool differs_from(const NoiseSpectrum& other, double share) const;
};

}  // namespace modcal
