#include "libinverse/spectral/choices/l_curve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

struct Slope {
  double residual = 0.0;
  double solution = 0.0;
};

// d log‖r‖/d log λ and d log‖x‖/d log λ over ± stride points. Quotients, not differences of
// logarithms: scaling the data by a power of two then changes no bit.
std::vector<Slope> slopes_of(std::span<const CurvePoint> curve, std::size_t stride) {
  std::vector<Slope> slopes(curve.size());
  for (std::size_t j = stride; j + stride < curve.size(); ++j) {
    const CurvePoint& low = curve[j - stride];
    const CurvePoint& high = curve[j + stride];
    const double width = std::log(high.parameter / low.parameter);
    slopes[j] = {std::log(high.residual_norm / low.residual_norm) / width,
                 std::log(high.solution_norm / low.solution_norm) / width};
  }
  return slopes;
}

std::size_t stride_of(std::span<const CurvePoint> curve, double span) {
  if (curve.size() < 2) return 1;
  const double decades = std::log10(curve.back().parameter / curve.front().parameter);
  const double step = decades / static_cast<double>(curve.size() - 1);
  return std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(span / step)));
}

}  // namespace

void LCurve::Options::visit(OptionVisitor& visitor) {
  curve.visit(visitor);
  visitor.number({.key = "span",
                  .meaning = "half span of the differences behind the curvature, in decades of the "
                             "parameter; 0: neighboring points",
                  .unit = "1",
                  .range = Range::closed(0.0, 10.0)},
                 span);
}

LCurve::LCurve(const Options& options) : ParameterChoice(options.curve, 5), span_(options.span) {
  MODCAL_REQUIRE(span_ >= 0.0 && std::isfinite(span_), "span of {:g} decades must be >= 0", span_);
}

ParameterChoice::Pick LCurve::pick(const Regularizer& /*regularizer*/, const SpectralData& /*data*/,
                                   std::span<CurvePoint> curve) const {
  const std::size_t stride = stride_of(curve, span_);
  const std::vector<Slope> slopes = slopes_of(curve, stride);
  const CurvePoint* best = nullptr;
  for (std::size_t j = 2 * stride; j + 2 * stride < curve.size(); ++j) {
    const Slope& low = slopes[j - stride];
    const Slope& high = slopes[j + stride];
    const double width = std::log(curve[j + stride].parameter / curve[j - stride].parameter);
    const Slope slope = slopes[j];
    const double turn = slope.residual * (high.solution - low.solution) -
                        slope.solution * (high.residual - low.residual);
    const double speed = std::hypot(slope.residual, slope.solution);
    const double curvature = turn / (width * speed * speed * speed);
    if (!std::isfinite(curvature)) continue;  // a norm is 0 there, or the curve stands still
    curve[j].criterion = curvature;
    if (!best || curvature > best->criterion) best = &curve[j];
  }
  if (!best || !(best->criterion > 0.0)) {
    return {curve.front().parameter, ChoiceStatus::kNotReached,
            "the L-curve has no corner (no positive curvature); the lowest parameter stands in"};
  }
  return {best->parameter, ChoiceStatus::kChosen,
          fmt::format("largest curvature {:.4g} at {:.4g}", best->criterion, best->parameter)};
}

}  // namespace modcal
