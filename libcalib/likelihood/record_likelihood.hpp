// One record of a fit to several.
#pragma once

#include "libcalib/likelihood/likelihood_outputs.hpp"
#include "libcalib/parameters/parameters.hpp"

namespace modcal {

/// What a fit of several records asks of each: a stroke of unknown force, or a pluck.
class RecordLikelihood {
 public:
  virtual ~RecordLikelihood() = default;
  /// Columns of what the record does not know are zero. A pluck gives of the outputs residuals,
  /// Jacobian and the information twice weighted.
  virtual LikelihoodPoint evaluate(const ModelPoint& point, const LikelihoodColumns& columns,
                                   const LikelihoodOutputs& outputs) const = 0;
  /// Cost and slope; the information where that costs no more.
  virtual LikelihoodPoint slope(const ModelPoint& point, const LikelihoodColumns& columns) const {
    return evaluate(point, columns, {});
  }
  /// Numbers of its residuals.
  virtual std::size_t residual_count() const = 0;
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
