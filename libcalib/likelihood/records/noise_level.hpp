// White noise of a record, read above its modes.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "libcalib/problem/calibration_data.hpp"
#include "libsim/model/modal_basis.hpp"

namespace modcal {

/// Where a record shows its noise, in parts of f_s.
struct NoiseBand {
  double low = 0.293;   ///< 15 kHz of 51.2 kHz
  double high = 0.488;  ///< 25 kHz: anti-aliasing filters begin above
  /// Well above the modes: the mean power is that of the noise. Otherwise their response still
  /// stands in it as lines, between which the median is.
  bool clear = true;

  /// From 0.293 f_s on where that is at least 1.4 f_N, else from the higher of 0.293 f_s and
  /// 1.1 f_N on. top: f_N > 0 [Hz]; sample_rate: f_s > 0 [Hz]. Throws InvalidInput where less than
  /// 200 bins of the record are left (a standard deviation of 7 % of the noise level).
  static NoiseBand above(double top, double sample_rate, std::size_t samples);
  static NoiseBand above(const ModalBasis& basis, double sample_rate, std::size_t samples);
};

/// Standard deviation of white noise [N] from the power in `band` under a Hann window (without it
/// the ends of the record leak 0.1–0.5 % of the signal into the band). Its own relative standard
/// deviation is about 0.7 % for 51 200 samples and a clear band of 0.195 f_s. Where the band is not
/// clear the median of the power is taken, ln 2 times the mean of an exponential law: on the
/// paper's case with f_N = 0.38 f_s the lines leave 4e-4 of the signal in it, in the mean 6e-3.
/// Not below 2e-4 of the signal's standard deviation: aliases of the force's jumps are no noise.
double noise_deviation(std::span<const double> samples, const NoiseBand& band);

/// Throws InvalidInput where a deviation is to be estimated (NaN) and the record leaves no band.
void require_noise_known(const std::array<double, 2>& stated, const ModalBasis& basis,
                         double sample_rate, std::size_t samples);

/// Relative standard deviation of the power of the noise of both ends together, as of_data() of
/// NoisyRecords estimates it: 0 where both deviations are stated (not NaN).
double noise_power_error(const std::array<double, 2>& stated, const ModalBasis& basis,
                         const CalibrationData& data);

}  // namespace modcal
