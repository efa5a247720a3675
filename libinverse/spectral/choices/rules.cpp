#include "libinverse/spectral/choices/rules.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libinverse/spectral/problem/spectral_system.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// Highest value met on the way from `index` in direction `step` before lower ground or the end.
double barrier(std::span<const double> values, std::size_t index, std::ptrdiff_t step) {
  const auto size = static_cast<std::ptrdiff_t>(values.size());
  double highest = values[index];
  for (std::ptrdiff_t i = static_cast<std::ptrdiff_t>(index) + step; i >= 0 && i < size;
       i += step) {
    const double value = values[static_cast<std::size_t>(i)];
    if (value < values[index]) break;
    highest = std::max(highest, value);
  }
  return highest;
}

void visit_noise_rms(OptionVisitor& visitor, double& noise_rms) {
  visitor("noise_rms",
          "standard deviation of the noise of one sample; measured: the level "
          "that comes with the data",
          {.unit = "N", .range = Range::non_negative(), .word = "measured"}, noise_rms);
}

void require_noise_option(double noise_rms) {
  MODCAL_REQUIRE(std::isnan(noise_rms) || (noise_rms >= 0.0 && std::isfinite(noise_rms)),
                 "standard deviation {:g} of the noise must be a finite number >= 0", noise_rms);
}

double known_noise_rms(double option, const SpectralData& data) {
  const double noise = std::isnan(option) ? data.noise_rms : option;
  MODCAL_REQUIRE(noise >= 0.0 && std::isfinite(noise),
                 "this parameter choice needs the noise level and the data do not state it: set "
                 "noise_rms, or choose a rule that does without");
  return noise;
}

}  // namespace

std::optional<InteriorMinimum> most_prominent_minimum(std::span<const double> values) {
  std::optional<InteriorMinimum> best;
  std::size_t count = 0;
  for (std::size_t begin = 1; begin + 1 < values.size(); ++begin) {
    if (!(values[begin] > 0.0) || !(values[begin - 1] > values[begin])) continue;
    std::size_t end = begin + 1;  // behind the plateau
    while (end < values.size() && values[end] == values[begin]) ++end;
    if (end == values.size() || !(values[end] > values[begin])) continue;
    ++count;
    const double saddle = std::min(barrier(values, begin, -1), barrier(values, end - 1, +1));
    const double prominence = std::log10(saddle / values[begin]);
    const std::size_t middle = (begin + end - 1) / 2;
    if (!best || prominence > best->prominence) best = InteriorMinimum{middle, prominence, 0};
  }
  if (best) best->count = count;
  return best;
}

Pick minimal_product_on(std::span<CurvePoint> curve) {
  std::vector<double> product(curve.size());
  for (std::size_t j = 0; j < curve.size(); ++j) {
    product[j] = curve[j].residual_norm * curve[j].solution_norm;
    curve[j].criterion = product[j];
  }
  const auto minimum = most_prominent_minimum(product);
  if (!minimum) {
    return {curve.front().parameter, ChoiceStatus::kNoInteriorMinimum,
            fmt::format("the product has no local minimum between {:.4g} and {:.4g}; the lowest "
                        "parameter stands in",
                        curve.front().parameter, curve.back().parameter)};
  }
  const double parameter = curve[minimum->index].parameter;
  return {parameter, ChoiceStatus::kChosen,
          fmt::format("most prominent of {} interior local minima of the product at {:.4g}, {:.3f} "
                      "decades below its lower barrier",
                      minimum->count, parameter, minimum->prominence)};
}

Pick pick_minimal_product(const CurveRuleOptions& /*options*/, const TracedCurve& traced) {
  return minimal_product_on(traced.curve);
}

Pick cross_validation_on(std::span<CurvePoint> curve, double rows) {
  for (CurvePoint& point : curve) {
    const double left = rows - point.freedom;
    // With every datum fitted the quotient is 0/0 and says nothing.
    point.criterion = left > 0.0 ? point.residual_norm * point.residual_norm / (left * left)
                                 : std::numeric_limits<double>::quiet_NaN();
  }
  return ParameterChoice::smallest_criterion(curve, "generalized cross validation");
}

Pick pick_generalized_cross_validation(const CurveRuleOptions& /*options*/,
                                       const TracedCurve& traced) {
  return cross_validation_on(traced.curve, static_cast<double>(traced.data.problem->rows()));
}

void RobustCrossValidationOptions::visit(OptionVisitor& visitor) {
  curve.visit(visitor);
  visitor("gamma", "weight of plain cross validation; 1: nothing else",
          {.range = Range{0.0, 1.0, false, true}}, gamma);
}

void RobustCrossValidationOptions::require() const {
  MODCAL_REQUIRE(gamma > 0.0 && gamma <= 1.0, "gamma {:g} must lie in (0, 1]", gamma);
}

Pick pick_robust_cross_validation(const RobustCrossValidationOptions& options,
                                  const TracedCurve& traced) {
  const std::span<CurvePoint> curve = traced.curve;
  const double rows = static_cast<double>(traced.data.problem->rows());
  const std::vector<double> sigma = penalized_sigma(traced.regularizer, *traced.data.problem);
  const std::span<const double> multiplicity = traced.data.problem->multiplicity();
  std::vector<double> kept(sigma.size());
  for (CurvePoint& point : curve) {
    const double left = rows - point.freedom;
    if (!(left > 0.0)) continue;  // 0/0: every datum is fitted
    traced.regularizer.filter_factors(sigma, point.parameter, kept);
    double square = 0.0;
    for (std::size_t i = 0; i < kept.size(); ++i) square += multiplicity[i] * kept[i] * kept[i];
    point.criterion = (options.gamma + (1.0 - options.gamma) * square / rows) *
                      point.residual_norm * point.residual_norm / (left * left);
  }
  return ParameterChoice::smallest_criterion(curve, "robust cross validation");
}

Pick pick_quasi_optimality(const CurveRuleOptions& /*options*/, const TracedCurve& traced) {
  const std::span<CurvePoint> curve = traced.curve;
  const SpectralSystem system(traced.data, traced.measure);
  const std::vector<double> sigma = penalized_sigma(traced.regularizer, *traced.data.problem);
  std::vector<double> kept(sigma.size()), before(sigma.size());
  for (std::size_t j = 0; j < curve.size(); ++j) {
    traced.regularizer.filter_factors(sigma, curve[j].parameter, kept);
    if (j > 0) {
      double square = 0.0;
      for (std::size_t i = 0; i < kept.size(); ++i) {
        const double step = kept[i] - before[i];
        square += step * step * system.solution_weight[i] * system.power[i];
      }
      const double width = std::log(curve[j].parameter / curve[j - 1].parameter);
      if (square > 0.0) curve[j].criterion = std::sqrt(square) / width;
    }
    kept.swap(before);
  }
  return ParameterChoice::smallest_criterion(curve, "change of the solution");
}

Pick pick_evidence(const CurveRuleOptions& /*options*/, const TracedCurve& traced) {
  const std::span<CurvePoint> curve = traced.curve;
  const SpectralOperator& problem = *traced.data.problem;
  const double rows = static_cast<double>(problem.rows());
  const std::vector<double> sigma = penalized_sigma(traced.regularizer, problem);
  std::vector<double> kept(sigma.size()), lost(sigma.size());
  for (CurvePoint& point : curve) {
    traced.regularizer.filter_factors(sigma, point.parameter, kept, lost);
    double power = traced.data.outside_power, logarithms = 0.0;
    for (std::size_t i = 0; i < sigma.size(); ++i) {
      const double share = lost[i] > 0.0 ? lost[i] : 1.0 / (1.0 + rows);
      power += share * traced.data.power[i];
      if (share < 1.0) logarithms += problem.multiplicity()[i] * std::log(share);
    }
    const double criterion = rows * std::log(power) - logarithms;
    if (std::isfinite(criterion)) point.criterion = criterion;
  }
  return ParameterChoice::smallest_criterion(curve, "negative logarithm of the evidence");
}

Pick pick_cumulative_periodogram(const CurveRuleOptions& /*options*/, const TracedCurve& traced) {
  const std::span<CurvePoint> curve = traced.curve;
  const SpectralOperator& problem = *traced.data.problem;
  const std::vector<double> sigma = penalized_sigma(traced.regularizer, problem);
  std::vector<double> kept(sigma.size()), lost(sigma.size());
  std::vector<double> residual(sigma.size()), freedom(sigma.size());
  for (CurvePoint& point : curve) {
    traced.regularizer.filter_factors(sigma, point.parameter, kept, lost);
    double total = 0.0, all = 0.0;
    for (std::size_t i = 0; i < sigma.size(); ++i) {
      const std::uint32_t place = problem.order()[i];
      residual[place] = lost[i] * lost[i] * traced.data.power[i];
      freedom[place] = problem.multiplicity()[i];
      total += residual[place];
      all += freedom[place];
    }
    if (!(total > 0.0)) continue;  // no residual: nothing to compare
    double sum = 0.0, white = 0.0, distance = 0.0;
    for (std::size_t i = 0; i < sigma.size(); ++i) {
      sum += residual[i] / total;
      white += freedom[i] / all;
      distance = std::max(distance, std::abs(sum - white));
    }
    point.criterion = distance;
  }
  return ParameterChoice::smallest_criterion(curve, "distance of the residual from white noise");
}

void PredictiveRiskOptions::visit(OptionVisitor& visitor) {
  curve.visit(visitor);
  visit_noise_rms(visitor, noise_rms);
}

void PredictiveRiskOptions::require() const { require_noise_option(noise_rms); }

Pick pick_predictive_risk(const PredictiveRiskOptions& options, const TracedCurve& traced) {
  const std::span<CurvePoint> curve = traced.curve;
  const double noise = known_noise_rms(options.noise_rms, traced.data);
  const double rows = static_cast<double>(traced.data.problem->rows());
  for (CurvePoint& point : curve) {
    point.criterion =
        point.residual_norm * point.residual_norm + (2.0 * point.freedom - rows) * noise * noise;
  }
  return ParameterChoice::smallest_criterion(curve, "predictive risk");
}

void DiscrepancyOptions::visit(OptionVisitor& visitor) {
  curve.visit(visitor);
  visitor("tau", "safety factor on the norm of the noise", {.range = Range::at_least(1.0)}, tau);
  visit_noise_rms(visitor, noise_rms);
}

void DiscrepancyOptions::require() const {
  MODCAL_REQUIRE(tau >= 1.0 && std::isfinite(tau), "tau {:g} must be a finite number >= 1", tau);
  require_noise_option(noise_rms);
}

Pick discrepancy_on(std::span<CurvePoint> curve, double bound) {
  std::size_t within = 0;  // the residual rises with the parameter
  for (std::size_t j = 0; j < curve.size(); ++j) {
    if (bound > 0.0) curve[j].criterion = curve[j].residual_norm / bound;
    if (curve[j].residual_norm <= bound) within = j + 1;
  }
  if (within == 0) {
    return {curve.front().parameter, ChoiceStatus::kNotReached,
            fmt::format("the residual norm stays above {:.4g} down to the lowest parameter, which "
                        "stands in",
                        bound)};
  }
  if (within == curve.size()) {
    return {curve.back().parameter, ChoiceStatus::kEdgeOfRange,
            fmt::format("the residual norm {:.4g} at the upper edge of the searched range is still "
                        "within {:.4g}",
                        curve.back().residual_norm, bound)};
  }
  const CurvePoint& point = curve[within - 1];
  return {point.parameter, ChoiceStatus::kChosen,
          fmt::format("largest parameter whose residual norm {:.4g} is within {:.4g}",
                      point.residual_norm, bound)};
}

Pick pick_discrepancy(const DiscrepancyOptions& options, const TracedCurve& traced) {
  const double rows = static_cast<double>(traced.data.problem->rows());
  return discrepancy_on(
      traced.curve,
      options.tau * known_noise_rms(options.noise_rms, traced.data) * std::sqrt(rows));
}

void GivenParameterOptions::visit(OptionVisitor& visitor) {
  visitor("value", "regularization parameter, in the unit of the transfer function",
          {.range = Range::non_negative(), .required = true}, value);
  curve.visit(visitor);
}

void GivenParameterOptions::require() const {
  MODCAL_REQUIRE(value >= 0.0 && std::isfinite(value),
                 "fixed regularization parameter {:g} must be a finite number >= 0", value);
}

Pick pick_given_parameter(const GivenParameterOptions& options, const TracedCurve& /*traced*/) {
  return {options.value, ChoiceStatus::kGiven, "the parameter was given"};
}

}  // namespace modcal
