// Response functions of a structure as they were measured: a model without modes.
#pragma once

#include <cstdint>

#include "libinverse/structure/structure_record.hpp"

namespace modcal {

using Transfers = std::vector<std::vector<Complex>>;  ///< H of every sensor at every bin

/// H_k(s) of one contact at the lines of a grid from 0 on, of one session of measurements or of
/// several, in the sensors' units per newton.
struct MeasuredFunctions {
  FrequencyGrid grid;               ///< sigma: 1/τ of an exponential window; 0: none
  std::vector<SensorKind> sensors;  ///< K
  std::vector<Transfers> sessions;  ///< S × K × lines; what lies below the first line is NaN
  /// E|δH|²/|H|² of every line of the first session by its coherence; K, empty: not told.
  std::vector<std::vector<double>> random;
  std::vector<double>
      scatter;  ///< share of |H| by which each sensor's may be off besides, K; empty: 0

  bool empty() const { return sessions.empty(); }

  /// The measured lines of a session in a band [Hz], as the spectra of a strike with a force of 1.
  /// Throws InvalidInput for a band without lines or with one that is not finite, and for another
  /// number of functions or lines than stated.
  ContourSpectra lines(std::size_t session, double low, double high) const;

  /// The mean of the sessions at the bins of a record.
  Transfers at(const ContourSpectra& spectra) const;

  /// E|δH_k|² of a further session at the bins: (1 + 1/S) of the scatter of the sessions about
  /// their mean, of coherence |H|² (1 − γ²)/(n γ²) (Bendat and Piersol, 2010, eq. 9.55), of
  /// `scatter` its square times |H|², and |H|² about the band's end times the weight that the
  /// contour gives to what lies above the last line.
  std::vector<std::vector<double>> variances(const ContourSpectra& spectra) const;

  /// Functions of a further session, drawn with those variances: a combination of the sessions,
  /// which keeps what bins and sensors have in common, noise of its own on every line, and a factor
  /// that changes over kReach, each `wide` times as far off.
  Transfers drawn(const ContourSpectra& spectra, double wide, std::uint64_t seed,
                  std::size_t draw) const;

  /// The rms of an impulse response late in 1/Δf over that of its first quarter, the largest of the
  /// sensors': near 1 where the lines are too far apart for what rings.
  double rings_on() const;
};

}  // namespace modcal
