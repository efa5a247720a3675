// One record of a fit to several.
#pragma once

#include "libcalib/likelihood/likelihood_outputs.hpp"
#include "libcalib/parameters/parameters.hpp"

namespace modcal {

/// What a fit of several records asks of each: a stroke of unknown force, or a pluck.
class RecordLikelihood {
 public:
  virtual ~RecordLikelihood() = default;
  /// Columns of what the record does not know are zero.
  virtual LikelihoodPoint evaluate(const ModelPoint& point, const LikelihoodColumns& columns,
                                   bool twice_weighted) const = 0;
  /// N̄: what noise adds to the information.
  virtual Eigen::MatrixXd noise_information(const ModelPoint& point,
                                            const LikelihoodColumns& columns) const = 0;
  /// The same without weights.
  virtual LikelihoodPoint unweighted(const ModelPoint& point,
                                     const LikelihoodColumns& columns) const = 0;
  /// Residuals less unknowns projected out.
  virtual double degrees_of_freedom(const ModelPoint& point) const = 0;
};

}  // namespace modcal
