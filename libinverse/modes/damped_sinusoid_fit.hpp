// Maximum likelihood of damped sinusoids in white noise.
#pragma once

#include <span>
#include <vector>

#include "libinverse/modes/decay_record.hpp"

namespace modcal {

struct DampedSinusoidFit {
  std::vector<DecayMode> modes;
  std::vector<double> noise;  ///< standard deviation of the residual of each channel
  std::vector<std::vector<double>> residual;  ///< of each channel
  std::vector<double> squares;                ///< of the residual of each channel, their sum
  std::size_t iterations = 0;
  bool converged = false;
  bool full_rank = false;  ///< false: two poles cannot be told apart, there are no error bars
};

struct DampedSinusoidOptions {
  std::size_t iterations = 50;
  double tolerance = 1e-6;  ///< largest step, in standard deviations of the parameter
  /// Variance of the noise within the band over that of the record (DecimatedDecay): error bars are
  /// those of the noise the modes see.
  double in_band_variance = 1.0;
  std::vector<double> lines;  ///< of the mains, with amplitudes of their own (hum_columns) [Hz]
};

/// Minimum of Σ_c ‖y_c − c_c − Σ_k Re(A_ck exp(λ_k t))‖²/v_c over the poles, common to all
/// channels, and, for given poles, over amplitudes and constants, those of the lines too, which are
/// linear (variable projection, Golub and Pereyra, 1973; the Jacobian of Kaufman, 1975, analytic):
/// Gauss–Newton steps, damped until the sum falls (Marquardt, 1963). v_c are the residual
/// variances, estimated along the way: for white noise the maximum of the likelihood. Deviations
/// are the Cramér–Rao bound at the optimum. start: poles near the optimum, within about 1/T of it
/// each. Throws InvalidInput for an invalid record, no pole, a pole that does not decay or lies
/// above half the rate, and fewer samples than unknowns.
DampedSinusoidFit fit_damped_sinusoids(const DecayRecord& record, std::span<const DecayPole> start,
                                       const DampedSinusoidOptions& options = {});

/// Beside a pole that cannot start a fit, as one that does not decay or lies above half the rate.
DecayPole startable(DecayPole pole, double sample_rate);

/// By how much χ² rises from one fit of a record to another, the noise that of the first.
double chi_square_rise(const DampedSinusoidFit& from, const DampedSinusoidFit& to,
                       double in_band_variance);

/// Iterations times poles times samples times channels.
double work_of(const DampedSinusoidFit& fit);

}  // namespace modcal
