// What a calibration is fitted to.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "libsim/model/transfer.hpp"

namespace modcal {

/// Spectra of the reactions at the two ends, either of which may be missing.
struct CalibrationData {
  /// DFT of each reaction in the convention of libsim/signal/fft.hpp, K/2 + 1 bins [N]; empty where
  /// the reaction was not measured. Index: End.
  std::array<std::vector<Complex>, 2> reactions;
  std::size_t samples = 0;   ///< record length K
  double sample_rate = 0.0;  ///< f_s [Hz]

  /// Data of two records of one length [N]; an empty span is a missing reaction. Throws
  /// InvalidInput where nothing is left, lengths differ, or a sample is not finite.
  static CalibrationData of_records(std::span<const double> left, std::span<const double> right,
                                    double sample_rate);

  FrequencyGrid grid() const { return FrequencyGrid::of_record(samples, sample_rate); }
  bool has(End end) const { return !reaction(end).empty(); }
  bool has_both() const { return has(End::kLeft) && has(End::kRight); }
  const std::vector<Complex>& reaction(End end) const {
    return reactions[static_cast<std::size_t>(end)];
  }
  /// Throws InvalidInput unless there is a reaction and every one present has K/2 + 1 finite bins.
  void require_valid() const;
  /// Throws InvalidInput for a reaction that never moves: zeros, or one level throughout.
  void require_motion() const;
};

/// One record of a problem: a stroke, whose force is unknown, or the string left to itself after a
/// pluck.
struct CalibrationRecord {
  CalibrationData data;
  /// Noise standard deviation of each reaction [N]; NaN: as the objective has it.
  std::array<double, 2> noise{std::numeric_limits<double>::quiet_NaN(),
                              std::numeric_limits<double>::quiet_NaN()};
  bool pluck = false;
  bool recorded = false;  ///< it is no simulation of a model of stated modes alone
};

}  // namespace modcal
