// The two reactions as the observer uses them, with what they say by themselves about their noise
// and their lost static levels.
#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "libinverse/observer/parameter_space.hpp"
#include "libsim/model/modal_basis.hpp"
#include "libsim/model/transfer.hpp"

namespace modcal::observer {

struct ObservedRecord {
  ModalBasis basis;
  double contact = 0.0;      ///< x_c [m]
  double sample_rate = 0.0;  ///< [Hz]
  /// Reactions z₁, z₂ [N]; both negated where the bow moves in the negative direction.
  std::vector<double> reaction[2];
  double noise[2] = {};            ///< standard deviation s of a sample's noise, with its floor [N]
  double raw_noise[2] = {};        ///< the same without floor [N]
  double noise_deviation[2] = {};  ///< relative standard deviation of raw_noise² as estimated [1]
  double offset[2] = {};           ///< mean before the first wave arrives [N]
  std::size_t silent[2] = {};      ///< samples before the first wave arrives
  bool negated = false;

  std::size_t samples() const { return reaction[0].size(); }
};

inline constexpr double kUnknownNoise[2] = {std::numeric_limits<double>::quiet_NaN(),
                                            std::numeric_limits<double>::quiet_NaN()};

/// White noise as estimated.
struct WhiteNoise {
  double rms = 0.0;        ///< [N]
  double deviation = 0.0;  ///< relative standard deviation of rms² [1]
};

/// Standard deviation of white noise [N] from the part of a Hann-windowed spectrum between
/// `lowest` [Hz], above the signal, and 0.98 of half the sample rate. Throws InvalidInput where
/// that band holds fewer than 8 bins.
WhiteNoise noise_above(std::span<const double> samples, double sample_rate, double lowest);

/// Samples before a wave that leaves the contact at t = 0 reaches the end, speed c = 2 L f₁.
std::size_t silent_samples(const ModalBasis& basis, double contact, End end, double sample_rate);

/// Reaction in the silent samples to a unit force held from t = 0 [1], as √(mean² + variance/n): a
/// string of finitely many modes ripples ahead of the first wave, and the mean of n samples takes
/// that for its offset.
double silent_ripple(const ModalBasis& basis, double contact, End end, double sample_rate);

/// Record that starts at rest. Noise from the band above 1.22 times the highest mode. Throws
/// InvalidInput for reactions of different lengths, samples that are not finite and records shorter
/// than four periods. `noise_rms`: as stated [N]; NaN: from the record.
ObservedRecord observe_record(const ModalBasis& basis, double contact, double sample_rate,
                              std::span<const double> left, std::span<const double> right,
                              const double (&noise_rms)[2] = kUnknownNoise);

/// Standard deviation of the mean of an end's silent samples about its offset [N], bow velocity
/// v_bow [m/s]: their noise, and the ripple of the 2 Z₀ v_bow that the bow draws until the first
/// wave is back.
double silent_deviation(const ObservedRecord& record, End end, double bow_velocity);

/// Prior deviation of the offset of reaction r [N]: noise of the silent samples, and the ripple of
/// a finite number of modes ahead of the first wave.
double offset_deviation(const ObservedRecord& record, int r);

void negate(std::vector<double>& samples);
/// The record with both reactions negated: a bow moving in the other direction.
void negate(ObservedRecord& record);

/// Linear estimate of the motion at the contact from both reactions.
struct LinearEstimate {
  std::vector<double> force;     ///< [N]
  std::vector<double> velocity;  ///< [m/s]
  /// Standard deviation of force [N] under the sensors' noise; what the band limit cuts off is not
  /// in it.
  std::vector<double> force_deviation;
};

/// Joint estimate on the contour s = 2/T + iω, F = Σ_r H̄_r R_r/s_r² ÷ Σ_r |H_r|²/s_r² up to the
/// highest mode and 0 above, the offsets taken off first. Weighting by e^{−2t/T} holds what the
/// transform wraps down to e^{−2}.
LinearEstimate linear_estimate(const ObservedRecord& record);

/// What a linear estimate shows of bow and friction.
struct ContactPicture {
  double bow_velocity = 0.0;   ///< mode of the histogram of v after the transient [m/s]
  double slip_speed = 0.0;     ///< v_bow minus the 1 % quantile of v [m/s]
  double dynamic_force = 0.0;  ///< median of f while it slides fast [N]
  double static_force = 0.0;   ///< 99.5 % quantile of f, at least 1.3 F_D [N]
};

/// Direction of the bow: +1 or −1, the sign of the most frequent velocity.
double bow_direction(const LinearEstimate& estimate);

/// For a bow that moves in the positive direction. Throws InvalidInput where the estimate shows no
/// stick and slip.
ContactPicture picture_of(const LinearEstimate& estimate);

}  // namespace modcal::observer
