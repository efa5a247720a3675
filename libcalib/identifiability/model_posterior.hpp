// The models that a fit leaves possible, for what is computed from a model.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "libcalib/parameters/string_unknowns.hpp"
#include "libsim/base/random.hpp"

namespace modcal {

/// θ ~ N(θ̂, C) of the unknowns of one record.
struct ModelPosterior {
  StringUnknowns unknowns;
  Eigen::VectorXd theta;       ///< θ̂; empty: nothing was estimated
  Eigen::MatrixXd covariance;  ///< C

  /// Models of independent θ̂ + C^½ z, z standard normal; of those that no string can have another
  /// is drawn. Fewer than asked for where hardly any can.
  std::vector<ModelPoint> draw(std::size_t count, const StreamKey& key) const;
};

}  // namespace modcal
