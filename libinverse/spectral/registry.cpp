#include <array>

#include "libinverse/spectral/choices/rules.hpp"
#include "libinverse/spectral/regularizers/regularizers.hpp"

namespace modcal {

Registry<Regularizer> Regularizer::registry() {
  static constexpr std::array kTable = {
      entry_of<Regularizer, NoRegularization>("none", "direct inversion"),
      entry_of<Regularizer, Tikhonov>("tikhonov", "Tikhonov regularization of order 0, 1 or 2"),
      entry_of<Regularizer, TruncatedSvd>("truncated_svd", "largest singular values alone"),
      entry_of<Regularizer, WaterLevel>("water_level",
                                        "water level that zeroes: nothing is inverted below it"),
      entry_of<Regularizer, WaterLevelClip>(
          "water_level_clip", "water level that clips: |H| is raised to it, its phase kept"),
      entry_of<Regularizer, WienerFilter>("wiener", "Wiener filter for a force that jumps"),
  };
  return kTable;
}

Registry<ParameterChoice> ParameterChoice::registry() {
  static constexpr std::array kTable = {
      entry_of<ParameterChoice, Discrepancy>("discrepancy", "residual as large as the known noise"),
      entry_of<ParameterChoice, Evidence>("evidence", "largest Bayesian evidence"),
      entry_of<ParameterChoice, GivenParameter>("fixed", "a parameter given by the user"),
      entry_of<ParameterChoice, GeneralizedCrossValidation>("gcv", "generalized cross validation"),
      entry_of<ParameterChoice, LCurve>("l_curve", "largest curvature of the L-curve"),
      entry_of<ParameterChoice, LCurveAdaptive>("l_curve_adaptive",
                                                "corner of the L-curve by adaptive pruning"),
      entry_of<ParameterChoice, MinimalProduct>(
          "minimal_product", "interior local minimum of residual norm times solution norm"),
      entry_of<ParameterChoice, CumulativePeriodogram>(
          "ncp", "residual most like white noise: normalized cumulative periodogram"),
      entry_of<ParameterChoice, QuasiOptimality>("quasi_optimality",
                                                 "solution that changes least with the parameter"),
      entry_of<ParameterChoice, RobustCrossValidation>("robust_gcv",
                                                       "robust generalized cross validation"),
      entry_of<ParameterChoice, PredictiveRisk>(
          "upre", "unbiased predictive risk estimate with known noise"),
  };
  return kTable;
}

}  // namespace modcal
