// Modes of a structure from strikes whose force was measured.
#pragma once

#include "libinverse/structure/structure_record.hpp"
#include "libinverse/structure/structure_table.hpp"

namespace modcal {

/// How the modes are fitted.
struct StrikeFitOptions {
  double low = 0.0, high = 0.0;  ///< band [Hz]
  /// Contour [1/s]; NaN: 20 over the shortest duration, which leaves nothing of the end, but no
  /// more than weighs 50 periods of `high` by 1/e: a shorter record keeps its end, of which the
  /// columns know.
  double sigma = std::numeric_limits<double>::quiet_NaN();
  std::size_t most_modes = 60;
  /// Error of the model in a bin, as a share of the response about it [1].
  double relative_error = 0.02;
};

/// One step of the search: so many modes, how much they leave.
struct ModeCount {
  std::size_t modes = 0;
  double misfit = 0.0;           ///< weighted cost over its degrees of freedom
  double criterion = 0.0;        ///< BIC
  std::vector<ModalPole> poles;  ///< as they are then
};

/// One strike, and what the modes of all make of it.
struct FittedStrike {
  ContourSpectra spectra;
  std::vector<std::vector<Complex>> modeled;  ///< responses of the model at its bins, K
  std::vector<double> residuals;              ///< rms of what is left over rms of the response, K
  std::vector<ModalPole> poles;  ///< fitted to it alone; empty: there is no other strike
};

struct StrikeFit {
  StructureTable table;
  std::vector<ModeCount> steps;
  std::vector<double> residuals;  ///< those of the strikes, together; K
  double misfit = 0.0;            ///< χ² over its degrees of freedom
  std::vector<FittedStrike> strikes;
  /// Modes that may be none of the structure's, by their place: outside of the band, or told to no
  /// better than kToldWidth. They stand for many, or for what leaks from line to line.
  std::vector<std::size_t> stand_ins;
  /// Modes that the sensors pull apart (PoleSearch::variance_between()), as two that stand so close
  /// that they are taken for one. Their deviations hold that.
  std::vector<std::size_t> disputed;
  /// Modes in whose place two fit better what rings late, by BIC on a finer contour: they stand
  /// close together, or the frequency of one falls with its amplitude. Deviations hold both.
  std::vector<std::size_t> doubled;
  /// By how much ln f and ln ζ of a mode differ from strike to strike, rms; the median of the
  /// modes. NaN: one strike.
  double frequency_scatter = std::numeric_limits<double>::quiet_NaN();
  double damping_scatter = std::numeric_limits<double>::quiet_NaN();

  /// Why these are no modes of the structure: they leave more than half of a response; else empty.
  /// names: what the strikes are called.
  std::string rejection(std::span<const std::string> names = {}) const;
  /// Names a mode that stands at the least damping ratio that is tried: the record was damped less
  /// than is supposed; else empty.
  std::string without_damping() const;
};

/// Poles common to all sensors, complex modal constants and static terms (ModalModel), by weighted
/// least squares on a contour s = σ + iω, linear unknowns eliminated (Golub and Pereyra, 1973;
/// Kaufman, 1975). One mode more at a time, where it takes most from the misfit, as long as
/// BIC = n ln(cost/n) + p ln n falls (Schwarz, 1978); n bins that tell alike count as one. The
/// structure is at rest at t = 0; rebounds are part of the force. Strikes at one place have poles
/// and modal constants in common. Of one, the table's deviations are those of the fit; of several,
/// those of a further strike, by the poles of each alone (further_strike()), and what the structure
/// changes between them is part of the table's scatter. Throws InvalidInput for a record without
/// force, strikes of different sensors or the same samples, a band without bins, or one that has
/// fewer numbers than one mode takes.
StrikeFit fit_strikes(std::vector<StructureRecord> records, const std::vector<SensorKind>& kinds,
                      const StrikeFitOptions& options);

/// The same for measured H_k(σ + iω) of one session or more. The force is 1 everywhere and nothing
/// rings on. What is left grows with the force: the table's scatter is modal, its noise 0, and it
/// has no pulse. Throws InvalidInput for another number of lines, one of the band that is not
/// finite, and as above.
StrikeFit fit_response(const MeasuredFunctions& measured, const StrikeFitOptions& options);

}  // namespace modcal
