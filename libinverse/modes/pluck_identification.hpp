// From a plucked string's reactions to its modes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "libinverse/modes/damped_sinusoid_fit.hpp"
#include "libinverse/modes/stabilization.hpp"
#include "libsim/base/options.hpp"

namespace modcal {

struct PluckOptions {
  double lowest_frequency = 0.0;              ///< modes below are left alone [Hz]
  double highest_frequency = 2300.0;          ///< modes above are left alone [Hz]
  std::string method = "maximum_likelihood";  ///< or era
  double skip = 2e-3;                         ///< time left out after the pluck [s]
  std::int64_t block_rows = 150;              ///< of the Hankel matrix
  std::int64_t columns = 400;                 ///< of the Hankel matrix
  StabilizationOptions stabilization;
  void visit(OptionVisitor& visitor);
};

/// A mode with its number.
struct PluckedMode {
  std::size_t number = 0;  ///< n
  DecayMode mode;
};

struct PluckIdentification {
  std::vector<PluckedMode> modes;  ///< ascending, one a number
  std::vector<StabilizationPoint> diagram;
  std::vector<double> singular_values;  ///< of the Hankel matrix
  std::vector<std::size_t> missing;     ///< numbers below the highest with no mode
  /// Second poles of modes, with their numbers, as of a string that moves in two planes; ascending.
  std::vector<PluckedMode> seconds;
  /// Numbers of modes that are neither one damped sinusoid nor two, by a departure twice as large
  /// as chance lets be; empty for era.
  std::vector<std::size_t> departing;
  /// Frequencies in the band, the loudest first, of what the fit leaves, χ² falling by twice as
  /// much there as chance lets it; empty for era [Hz].
  std::vector<double> left;
  /// Without a number and not beside a mode that has one, but at least a tenth of the largest: of a
  /// body, or of another string; ascending.
  std::vector<DecayMode> others;
  std::vector<DecayMode> poles;  ///< of the fit, those that are no modes, too
  std::vector<double> lines;     ///< of the mains [Hz]
  std::vector<double> noise;     ///< residual of each channel within the band; empty for era
  double duration = 0.0;         ///< of what was fitted [s]
  bool converged = false;        ///< the fit; true for era
  bool full_rank = false;        ///< error bars are known
};

/// Modes of a free decay: low-pass to the band, poles by the eigensystem realization algorithm (the
/// paper's route, section 7.1), those kept that are stable over the orders, and for
/// maximum_likelihood all of them fitted together as damped sinusoids, without those that noise may
/// be and with those that the residual has (fit_significant). Deviations are the Cramér–Rao bound
/// for maximum_likelihood; the spread over the orders, no error bar, for era. Modes are numbered
/// upwards along the law f = n f₀ √(1 + B n²) of those numbered before: far up a stiff string f/f₀
/// is off by more than one. Of two with one number the one is kept that is nearer to the law,
/// within 1 % of it the one with the larger amplitude; what is farther from a law of three modes
/// than f₀ may be stated has none. Where modes have second poles, deviations of the others hold
/// that they may, too (widen_by_seconds). A fit that does not converge is made again with the modes
/// that are missing, where the law has them. Hum of the mains, where there is some, is fitted
/// beside the modes; a pole that the record does not tell from one of its lines is no mode.
/// fundamental: f₀ to about 1 % [Hz]; NaN: of a structure without a law, whose modes are numbered
/// in order, each by itself. Throws InvalidInput for an invalid or too short record, a fundamental
/// that is not positive, an unknown method.
PluckIdentification identify_pluck(const DecayRecord& record, double fundamental,
                                   const PluckOptions& options = {});

/// What a second pole of a third of the amplitude, too near to be seen, may move the frequency of a
/// mode by [Hz], and the damping ratio by the same share of the frequency (unseen_distance()); NaN
/// for one whose second pole is known, and without error bars.
double unseen_shift(const PluckIdentification& found, const PluckedMode& plucked);

/// Throws InvalidInput, as identify_pluck() would, where `samples` at `sample_rate` [Hz] leave
/// nothing behind the time skipped, are too few for the filter of the band, or for the block rows
/// of the Hankel matrix after it.
void require_decay_length(std::size_t samples, double sample_rate, const PluckOptions& options);

}  // namespace modcal
