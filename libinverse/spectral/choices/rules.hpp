// The rules: each a function of the traced curve and, for some, of the data behind it.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "libinverse/parameter_choice.hpp"

namespace modcal {

/// A local minimum and how far it stands out.
struct InteriorMinimum {
  std::size_t index = 0;
  /// log₁₀ of the lower of the two barriers between the minimum and lower ground (or the end of the
  /// curve) on either side, over the minimum: its topographic prominence in decades.
  double prominence = 0.0;
  std::size_t count = 0;  ///< interior local minima on the whole curve
};

/// The most prominent interior local minimum of positive values, the first of equals. Ends,
/// plateaus that touch them and values that are not positive are no minima. Empty where there is
/// none.
std::optional<InteriorMinimum> most_prominent_minimum(std::span<const double> values);

/// Options of a rule that has none of its own.
struct CurveRuleOptions {
  CurveOptions curve = {};
  void visit(OptionVisitor& visitor) { curve.visit(visitor); }
};

/// The choice that `kPick`, a function of options and traced curve, makes on a curve of at least
/// `kLeastPoints` points. Options are checked by their require(), where they have one.
template <class OptionsT, auto kPick, std::int64_t kLeastPoints = 3>
class Rule final : public ParameterChoice {
 public:
  using Options = OptionsT;
  explicit Rule(const Options& options)
      : ParameterChoice(options.curve, kLeastPoints), options_(options) {
    if constexpr (requires { options.require(); }) options.require();
  }

 private:
  Pick pick(const TracedCurve& traced) const override { return kPick(options_, traced); }
  Options options_;
};

using Pick = ParameterChoice::Pick;

/// What rules that ask the curve alone choose on it, `rows` data [1] or a bound on the residual
/// norm given. They fill in the criterion.
Pick minimal_product_on(std::span<CurvePoint> curve);
Pick cross_validation_on(std::span<CurvePoint> curve, double rows);
Pick discrepancy_on(std::span<CurvePoint> curve, double bound);

Pick pick_minimal_product(const CurveRuleOptions& options, const TracedCurve& traced);
/// Minimal product: interior local minimum over ε of ‖R − H F_ε‖·‖dF_ε/dt‖ (Debut, Delaune and
/// Antunes, 2010, section 5; with the measure "solution": ‖R − H F_ε‖·‖F_ε‖). The product falls to
/// 0 when everything is cut off, so that end is no answer. The curve of a water level is a fine
/// sawtooth with dozens of local minima: the most prominent one on the logarithmic grid is meant,
/// the one whose basin takes the highest climb to leave.
/// Without an interior minimum the status says so and the lowest parameter stands in.
using MinimalProduct = Rule<CurveRuleOptions, &pick_minimal_product>;

struct LCurveOptions {
  CurveOptions curve = {};
  double span = 0.1;  ///< half span of the differences [decades]; 0: neighboring points
  void visit(OptionVisitor& visitor);
  /// Throws InvalidInput for a span that is negative or not finite.
  void require() const;
};
Pick pick_l_curve(const LCurveOptions& options, const TracedCurve& traced);
/// L-curve: the parameter of largest curvature of (log ‖r‖, log ‖x‖) (Hansen and O'Leary, 1993, eq.
/// 3.6), from central differences in log λ. The curve of a water level is a staircase, so that
/// differences are taken over a span of parameters and not between neighbors.
using LCurve = Rule<LCurveOptions, &pick_l_curve, 5>;

Pick pick_l_curve_adaptive(const CurveRuleOptions& options, const TracedCurve& traced);
/// L-curve by adaptive pruning: corners of the discrete curve (log ‖r‖, log ‖x‖) are sought on its
/// longest 5, 10, 20, … segments, by the sharpest turn and by the point nearest to where the flat
/// and the steep part would meet; the corner is the candidate with most regularization from which
/// the next one costs more in log ‖x‖ than it gains in log ‖r‖ (Hansen, Jensen and Rodriguez, 2007,
/// sections 3 and 4). Needs no smoothness: small clusters and staircases do not draw it away. The
/// criterion is the distance of a point from the corner in decades.
using LCurveAdaptive = Rule<CurveRuleOptions, &pick_l_curve_adaptive, 5>;

Pick pick_generalized_cross_validation(const CurveRuleOptions& options, const TracedCurve& traced);
/// Generalized cross validation: minimum of ‖r‖²/(m − Σ φ)², m the number of data (Golub, Heath and
/// Wahba, 1979, eq. 1.4). Needs no noise level; supposes white noise.
using GeneralizedCrossValidation = Rule<CurveRuleOptions, &pick_generalized_cross_validation>;

struct RobustCrossValidationOptions {
  CurveOptions curve = {};
  double gamma = 0.3;  ///< γ in (0, 1]; 1: generalized cross validation
  void visit(OptionVisitor& visitor);
  void require() const;
};
Pick pick_robust_cross_validation(const RobustCrossValidationOptions& options,
                                  const TracedCurve& traced);
/// Robust generalized cross validation: minimum of [γ + (1 − γ) μ] ‖r‖²/(m − Σ φ)², μ = Σ φ²/m
/// (Lukas, 2006, eq. 1.6): too little regularization costs more than in generalized cross
/// validation.
using RobustCrossValidation = Rule<RobustCrossValidationOptions, &pick_robust_cross_validation>;

Pick pick_quasi_optimality(const CurveRuleOptions& options, const TracedCurve& traced);
/// Quasi-optimality: minimum of ‖dx/d log λ‖, from differences of the solutions at neighboring
/// parameters (Tikhonov and Glasko, 1965; Hansen, 1998, section 7.5), in the norm of the measure.
/// Needs no noise level. Neighbors with the same solution (a truncation that cuts nothing between
/// them) say nothing.
using QuasiOptimality = Rule<CurveRuleOptions, &pick_quasi_optimality>;

Pick pick_evidence(const CurveRuleOptions& options, const TracedCurve& traced);
/// Bayesian evidence: maximum of the marginal likelihood of the data for Gaussian noise of unknown
/// level and a Gaussian solution whose prior makes φ the posterior mean, criterion
/// m log(Σ (1 − φ) |u_iᵀb|²) − Σ log(1 − φ) (MacKay, 1992, section 3, the level eliminated), m the
/// number of data. A component that a filter keeps whole (φ = 1) has the prior that is worth one
/// datum, 1 − φ = 1/(1 + m) (Kass and Wasserman, 1995).
using Evidence = Rule<CurveRuleOptions, &pick_evidence>;

Pick pick_cumulative_periodogram(const CurveRuleOptions& options, const TracedCurve& traced);
/// Normalized cumulative periodogram: the parameter whose residual is most like white noise,
/// minimum of the largest distance between the cumulative power of the residual's components and
/// that of white noise (Hansen, Kilmer and Kjeldsen, 2006, section 3). Components stand in the
/// order the problem gives them: the bins of a spectrum by frequency.
using CumulativePeriodogram = Rule<CurveRuleOptions, &pick_cumulative_periodogram>;

struct DiscrepancyOptions {
  CurveOptions curve = {};
  double tau = 1.0;  ///< τ ≥ 1 [1]
  /// s, in the unit of the data; NaN: as the data state it.
  double noise_rms = std::numeric_limits<double>::quiet_NaN();
  void visit(OptionVisitor& visitor);
  /// Throws InvalidInput for τ < 1.
  void require() const;
};
Pick pick_discrepancy(const DiscrepancyOptions& options, const TracedCurve& traced);
/// Discrepancy principle: the largest parameter with ‖r‖ ≤ τ s √m, s the standard deviation of the
/// noise and m the number of data (Morozov, 1966). The criterion is ‖r‖ over that bound.
using Discrepancy = Rule<DiscrepancyOptions, &pick_discrepancy>;

struct PredictiveRiskOptions {
  CurveOptions curve = {};
  /// s, in the unit of the data; NaN: as the data state it.
  double noise_rms = std::numeric_limits<double>::quiet_NaN();
  void visit(OptionVisitor& visitor);
  void require() const;
};
Pick pick_predictive_risk(const PredictiveRiskOptions& options, const TracedCurve& traced);
/// Unbiased predictive risk estimate: minimum of ‖r‖² + 2 s² Σ φ − m s², s the standard deviation
/// of the noise and m the number of data (Vogel, 2002, section 7.1). Supposes white noise of known
/// level.
using PredictiveRisk = Rule<PredictiveRiskOptions, &pick_predictive_risk>;

struct GivenParameterOptions {
  double value = std::numeric_limits<double>::quiet_NaN();  ///< parameter ≥ 0
  CurveOptions curve = {};
  void visit(OptionVisitor& visitor);
  /// Throws InvalidInput for a value that is negative or not finite.
  void require() const;
};
Pick pick_given_parameter(const GivenParameterOptions& options, const TracedCurve& traced);
/// A parameter given by the user. The curve is traced beside it unless its number of points is 0.
using GivenParameter = Rule<GivenParameterOptions, &pick_given_parameter, 0>;

}  // namespace modcal
