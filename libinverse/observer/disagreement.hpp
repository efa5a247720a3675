// One estimate of a signal held against another whose errors are known: what the first is off by.
#pragma once

#include <limits>
#include <span>
#include <vector>

namespace modcal::observer {

/// Mean square error of a bin of an estimate over a band, that of a sample being the mean over all
/// bins: S_D of the difference to a reference is e + v_k, v_k the variance of the reference.
struct BandError {
  double lowest = 0.0, highest = 0.0;  ///< [Hz]
  double square = 0.0;                 ///< e ≥ 0 [unit²]
  double deviation = 0.0;              ///< of e before it is kept from falling below 0 [unit²]
  double power = 0.0;                  ///< of the estimate itself, a bin's mean [unit²]
  double difference = 0.0;  ///< of its difference to the reference, a bin's mean [unit²]
};

/// What an estimate is held against.
struct Reference {
  std::span<const double> samples;
  std::span<const double> variance;  ///< v_k of the bins of an unpadded transform, K/2 + 1
  double sample_rate = 0.0;          ///< [Hz]
  /// Bins above it say nothing [Hz]; NaN: none does.
  double band_limit = std::numeric_limits<double>::quiet_NaN();
  /// Shares of the record between which it counts.
  double begin = 0.08, end = 0.95;
  /// x_k: what it may be off by beside v_k, as the estimate may be, too, which rests on the same
  /// reactions; empty: nothing.
  std::span<const double> excess = {};
};

/// e of half octaves up to the band limit, by moments weighted with 1/(e + v_k)², from
/// `begin` to `end` of the record (the ends of which no estimate knows well) under a Hann window.
/// It is right as long as the two err independently or the estimate by much less than its
/// reference. Throws InvalidInput for lengths that do not fit.
std::vector<BandError> band_errors(std::span<const double> estimate, const Reference& reference);

/// e of every bin, K/2 + 1: that of its band. Above the last band, which no reference reaches, a
/// share of the estimate's own power: that of the last band if the model is `trusted`, else all.
std::vector<double> bin_errors(std::span<const double> estimate, std::span<const BandError> bands,
                               double sample_rate, bool trusted);

/// The larger of an estimate's errors and the excess of its reference, bin by bin, below the band
/// limit.
std::vector<double> with_excess(std::vector<double> errors, const Reference& reference);

/// Mean square of a sample from that of all K/2 + 1 bins.
double sample_square(std::span<const double> bins, std::size_t samples);

/// Estimate and reference by the inverse of their squared errors, bin by bin: X = X_e + w (X_r −
/// X_e), w = e/(e + v). Above the band limit the estimate, or nothing unless `beyond`. Bin 0 is the
/// reference's.
std::vector<double> combined(std::span<const double> estimate, const Reference& reference,
                             std::span<const double> errors, bool beyond);

/// Mean square error of the bins of that combination: (1 − w)² of the estimate's, with the excess,
/// and w² (v + x).
std::vector<double> combined_errors(const Reference& reference, std::span<const double> errors,
                                    bool beyond);

/// Share of the estimate's bins in that combination, weighted by their variance in the reference:
/// 1 where it is the estimate alone, 0 where it is the reference.
double estimate_share(const Reference& reference, std::span<const double> errors);

}  // namespace modcal::observer
