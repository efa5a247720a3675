// Any linear problem in the eyes of the regularizers: a dense matrix through its SVD.
#pragma once

#include <Eigen/Core>
#include <limits>

#include "libinverse/parameter_choice.hpp"
#include "libinverse/regularizer.hpp"

namespace modcal {

struct SvdSolution {
  Eigen::VectorXd x;
  ChosenParameter choice;
};

/// b = A x + noise by filtered singular values, x = Σ_i φ(σ_i; λ) (u_iᵀb/σ_i) v_i (Hansen, 1998,
/// section 4.2). Prepared once per matrix; const and safe to use from several threads. Its measure
/// is "solution", ‖x‖: a matrix knows no time.
class SvdProblem {
 public:
  /// Throws InvalidInput for an empty matrix and entries that are not finite.
  explicit SvdProblem(const Eigen::MatrixXd& matrix);

  const SpectralOperator& problem() const { return problem_; }

  /// data: m rows. `noise_rms`: standard deviation of the noise of one datum, where the choice asks
  /// for it. Throws InvalidInput for another length or data that are not finite.
  SvdSolution solve(const Eigen::VectorXd& data, const Regularizer& regularizer,
                    const ParameterChoice& choice,
                    double noise_rms = std::numeric_limits<double>::quiet_NaN()) const;

 private:
  Eigen::MatrixXd left_;
  Eigen::MatrixXd right_;
  SpectralOperator problem_;
};

}  // namespace modcal
