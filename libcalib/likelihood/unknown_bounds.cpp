#include "libcalib/likelihood/unknown_bounds.hpp"

#include <algorithm>
#include <cmath>

namespace modcal {

using Index = Eigen::Index;

UnknownBounds unknown_bounds(const StringUnknowns& unknowns, const ModelPoint& initial,
                             const ParameterRanges& ranges) {
  const Eigen::VectorXd start = unknowns.start();
  const Eigen::VectorXd center = unknowns.theta_of(initial);
  UnknownBounds bounds{start, start};
  ParameterRanges copy = ranges;
  for (Index i = 0; i < unknowns.named(); ++i) {
    const ParameterName& name = unknowns.parameters()[static_cast<std::size_t>(i)];
    const ParameterType& type = type_of(name);
    const double range = type.range(copy);
    const bool share = type.range_kind == RangeKind::kShare;
    double lower = center[i] + (share ? std::log1p(-range) : -type.per_unit * range);
    double upper = center[i] + (share ? std::log1p(range) : type.per_unit * range);
    // A ratio may be as many times larger as smaller.
    if (type.moves == Moves::kDamping && share) upper = center[i] - std::log1p(-range);
    // From 0, which is as far below the reference as that is above it.
    if (type.range_kind == RangeKind::kRise) {
      ModelPoint reference = unknowns.model(start);
      lower = -*type.at(reference, name.index);
    }
    if (name.kind == ParameterKind::kInharmonicity) {
      lower = std::max(lower, ranges.lowest_of(unknowns.modes()));
    }
    bounds.lower[i] = std::min(lower, start[i]);
    bounds.upper[i] = std::max(upper, start[i]);
  }
  // The prior holds the response.
  const Index others = unknowns.size() - unknowns.named();
  bounds.lower.tail(others).setConstant(-sensor_type(Sensor::kGain).farthest);
  bounds.upper.tail(others).setConstant(sensor_type(Sensor::kGain).farthest);
  return bounds;
}

UnknownBounds unknown_bounds(const AllRecords& all, const ModelPoint& initial,
                             const ParameterRanges& ranges) {
  const UnknownBounds one = unknown_bounds(all.unknowns(), initial, ranges);
  UnknownBounds bounds{all.start(), all.start()};
  for (std::size_t r = 0; r < all.records(); ++r) {
    for (Index i = 0; i < all.unknowns().size(); ++i) {
      double& lower = bounds.lower[all.place(i, r)];
      double& upper = bounds.upper[all.place(i, r)];
      lower = std::min(lower, one.lower[i]);
      upper = std::max(upper, one.upper[i]);
    }
  }
  return bounds;
}

}  // namespace modcal
