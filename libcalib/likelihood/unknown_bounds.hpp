// How far the unknowns of a fit may go.
#pragma once

#include "libcalib/likelihood/all_records.hpp"

namespace modcal {

struct UnknownBounds {
  Eigen::VectorXd lower, upper;
  bool hold(const Eigen::VectorXd& theta) const {
    return (theta.array() >= lower.array()).all() && (theta.array() <= upper.array()).all();
  }
};

/// Bounds of θ by how far the parameters may go from their values in `initial`; those of damping
/// and sensors from the values stated. A start that is held beyond them stays where it is.
UnknownBounds unknown_bounds(const StringUnknowns& unknowns, const ModelPoint& initial,
                             const ParameterRanges& ranges);
UnknownBounds unknown_bounds(const AllRecords& all, const ModelPoint& initial,
                             const ParameterRanges& ranges);

}  // namespace modcal
