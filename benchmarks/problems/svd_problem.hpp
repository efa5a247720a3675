// Any linear problem in the eyes of the regularizers: a dense matrix through its SVD.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <vector>

#include "libinverse/parameter_choice.hpp"
#include "libinverse/regularizer.hpp"
#include "libinverse/spectral/problem/spectral_system.hpp"

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
  /// For regularizers without a penalty. Throws InvalidInput for an empty matrix and entries that
  /// are not finite.
  explicit SvdProblem(const Eigen::MatrixXd& matrix);

  /// For a regularizer that weighs frequencies (Tikhonov of order 1 and 2, Wiener), x being samples
  /// at distances `step` [s]: minimum of ‖b − A x‖² + λ² Σ_k p(ω_k)² y_k² with y = C x the cosine
  /// transform, ω_k = πk/(n step), in standard form (Eldén, 1977): σ_i are the singular values of
  /// A Cᵀ diag(1/p). A component with p = 0, the mean for a derivative, is never held down: it
  /// takes one datum and is found last. The measure "solution" is then ‖p y‖. Throws InvalidInput
  /// as above and unless step > 0.
  SvdProblem(const Eigen::MatrixXd& matrix, const Regularizer& regularizer, double step);

  const SpectralOperator& problem() const { return problem_; }

  /// data: m rows. `noise_rms`: standard deviation of the noise of one datum, where the choice asks
  /// for it. Throws InvalidInput for another length, data that are not finite, and a regularizer
  /// with another penalty than the problem is prepared for.
  SvdSolution solve(const Eigen::VectorXd& data, const Regularizer& regularizer,
                    const ParameterChoice& choice,
                    double noise_rms = std::numeric_limits<double>::quiet_NaN()) const;

 private:
  void decompose(const Eigen::MatrixXd& matrix, std::size_t rows, bool penalized);
  void require_penalty_of(const Regularizer& regularizer) const;
  Eigen::VectorXd filtered(const Eigen::VectorXd& coefficients, const Regularizer& regularizer,
                           double parameter) const;
  Eigen::VectorXd from_standard_form(const Eigen::VectorXd& data,
                                     const Eigen::VectorXd& solution) const;

  Eigen::MatrixXd left_;
  Eigen::MatrixXd right_;
  SpectralOperator problem_;
  // With a penalty: p(ω_k), A Cᵀ, Cᵀ, and the unit vector of A Cᵀ e_0 where p(0) = 0.
  std::vector<double> omega_, penalty_;
  Eigen::MatrixXd cosines_, transformed_;
  Eigen::VectorXd free_direction_;
};

}  // namespace modcal
