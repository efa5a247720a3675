// What an inversion finds: signals at the contact and how they were regularized.
#pragma once

#include <complex>
#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace modcal {

/// A regularized solution seen from outside, as a function of the parameter.
struct CurvePoint {
  double parameter = 0.0;      ///< in the unit of the singular values
  double residual_norm = 0.0;  ///< ‖b − A x‖ in the unit of the data
  double solution_norm = 0.0;  ///< ‖x‖ or ‖dx/dt‖, see Measure
  double freedom = 0.0;        ///< effective degrees of freedom, Σ multiplicity_i φ_i
  double criterion = 0.0;      ///< what the parameter choice looks at; NaN where it is not defined
};

enum class ChoiceStatus {
  kNotComputed,        ///< nothing has been chosen yet
  kChosen,             ///< the rule's condition is met inside the searched range
  kGiven,              ///< the parameter was given, not chosen
  kNoParameter,        ///< the regularizer has no parameter, or no component holds any signal
  kEdgeOfRange,        ///< the rule points to the edge of the searched range or beyond it
  kNoInteriorMinimum,  ///< the product curve has no local minimum inside the searched range
  kNotReached,         ///< no parameter searched meets the rule's condition
};

/// The status as a word for results: "chosen", "no_interior_minimum", …
std::string_view name_of(ChoiceStatus status);

/// Outcome of a parameter choice. A status other than kChosen, kGiven and kNoParameter says that
/// the parameter is a stand-in: the end of the range that regularizes least, or the edge named.
struct ChosenParameter {
  ChoiceStatus status = ChoiceStatus::kNotComputed;
  std::string explanation;  ///< one sentence with the figures behind the status
  CurvePoint point;         ///< the chosen parameter with its norms and criterion
  double kept_share = 0.0;  ///< effective share of the degrees of freedom kept, in [0, 1]; for
                            ///< a water level that zeroes: share of kept bins
  std::vector<CurvePoint> curve;  ///< every parameter searched, rising
  /// What to beware of: a parameter that stands in for one the rule did not find, or other rules
  /// that would have chosen one more than a decade away (disagreement_of).
  std::vector<std::string> warnings;

  double parameter() const { return point.parameter; }
};

/// A sentence for a parameter that stands in for one the rule did not find; empty for a chosen one.
std::string warning_of(const ChosenParameter& choice);

/// What an inversion computes. Each of the three signals costs an inverse transform.
struct InversionOutputs {
  bool force = true;
  bool displacement = false;
  bool velocity = false;
  bool force_spectrum = false;
  bool side_misfit = false;  ///< Estimate::side_misfit
  /// Standard deviations. The joint estimator leaves them out where they are not wanted: those of
  /// decays at unknown ends cost several times what the signals do.
  bool deviations = true;
};

/// Identified motion at the contact; what was not asked for is empty.
struct InversionResult {
  ChosenParameter choice;            ///< norms are sample norms: ‖r‖² = Σ_j r_j² [N], [N/s]
  std::size_t bins = 0;              ///< bins of the record besides k = 0
  std::size_t blind_bins = 0;        ///< of these, bins with H = 0: F = 0 there, whatever the force
  std::vector<double> force;         ///< f_c(t_j) [N], K samples of zero mean
  std::vector<double> displacement;  ///< y(x_c, t_j) [m]
  std::vector<double> velocity;      ///< v(x_c, t_j) [m/s]
  std::vector<std::complex<double>>
      force_spectrum;  ///< F_k, K/2 + 1, in the convention of libsim/signal/fft.hpp
};

/// Where an estimate comes from and what it is.
struct Estimate {
  std::string side;   ///< "1", "2", "joint", …: the key of tables
  std::string label;  ///< "from R1 (x = 0)", "from both reactions": for figures and warnings
  InversionResult result;
  /// f_c averaged over a sample period about every sample, undone below half the rate [N]: what
  /// sampling the force does not fold back. Empty: the force has nothing above the highest mode.
  std::vector<double> unaliased_force;
  double largest_transfer = 0.0;  ///< max |H| that the parameter is relative to [N/N]
  /// Standard deviations given the record: force [N], displacement [m], velocity [m/s]; NaN: none.
  double force_deviation = std::numeric_limits<double>::quiet_NaN();
  double displacement_deviation = std::numeric_limits<double>::quiet_NaN();
  double velocity_deviation = std::numeric_limits<double>::quiet_NaN();
  /// The same at every sample, where they differ; empty: the ones above.
  std::vector<double> force_deviations, velocity_deviations;
  /// Variance of every bin of force [N²] and velocity [(m/s)²] under the noise alone, that of a
  /// sample being its mean over all K bins; empty: not known.
  std::vector<double> force_variance, velocity_variance;
  /// What either sensor may err by beside its noise, as the other tells, adds to them.
  std::vector<double> force_excess, velocity_excess;
  /// Of the two sides, in every bin, about 40 Hz smoothed: 1 where they agree within their noise.
  std::vector<double> side_misfit;
  /// Nothing is identified above it, and the deviations are of the part below [Hz]; NaN: no limit.
  double band_limit = std::numeric_limits<double>::quiet_NaN();
  /// Misfit J of the innovations of an observer; NaN: the estimate has none.
  double misfit = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::pair<std::string, double>> figures;  ///< "sigma_T" and the like, for reports
  std::vector<std::string> notes;  ///< what was chosen by itself, one sentence each
  std::vector<std::string> warnings;
};

}  // namespace modcal
