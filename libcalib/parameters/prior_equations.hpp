// Gaussian statements about the unknowns of a fit, gathered to one quadratic form.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace modcal {

/// ½ (θ − mean)ᵀ precision (θ − mean).
struct QuadraticPrior {
  Eigen::MatrixXd precision;
  Eigen::VectorXd mean;
  double value(const Eigen::VectorXd& theta) const {
    return 0.5 * (theta - mean).dot(precision * (theta - mean));
  }
};

/// slope · z + offset.
struct LinearForm {
  Eigen::VectorXd slope;
  double offset = 0.0;
};

/// Frequencies scatter about the law f_n = n f_0 √(1 + B n²): ln f_n by widths_n, independently; B
/// to about `inharmonicity`.
struct LawScatter {
  Eigen::VectorXd widths;
  double inharmonicity = 0.0;
};

/// Statements a·z + offset = mean + N(0, C) about z = (θ, ln f_0, B). f_0 and B of the law, which
/// may be no unknowns of the fit, are integrated out: least squares eliminates them.
/// Mean and covariance of (ln f_0, B).
struct LawPosterior {
  Eigen::Vector2d mean;
  Eigen::Matrix2d covariance;
};

class PriorEquations {
 public:
  explicit PriorEquations(Eigen::Index unknowns);

  Eigen::Index unknowns() const { return unknowns_; }
  /// Each form has the mean stated; covariance: positive definite. A form of fewer unknowns is one
  /// of the first.
  void add(const std::vector<LinearForm>& forms, const Eigen::VectorXd& means,
           const Eigen::MatrixXd& covariance);
  void add(const LinearForm& form, double mean, double deviation);
  /// reference: ln f_n where δ_n, the first unknowns, are zero.
  void add_scatter(const LawScatter& law, const Eigen::VectorXd& reference);
  /// From here on z_i is known; an unknown of θ keeps a precision of 1 about it, which no other
  /// shares, so that a Newton step leaves it exactly where it is.
  void hold(Eigen::Index i, double value);
  /// z = (θ, ln f_0, B) with the f_0 and B that fit the statements best at θ; 0 for one that no
  /// statement is about or that is held.
  Eigen::VectorXd completed(const Eigen::VectorXd& theta) const;
  /// What the statements say of the law where the data have θ with that mean and covariance: their
  /// own scatter about the law joins it. 0 of what no statement is about or what is held.
  LawPosterior law(const Eigen::VectorXd& theta, const Eigen::MatrixXd& covariance) const;
  /// The mean is of smallest norm where the statements leave a direction of θ open.
  QuadraticPrior solve() const;

 private:
  Eigen::Matrix2d law_covariance() const;
  Eigen::Index unknowns_;
  Eigen::MatrixXd normal_;
  Eigen::VectorXd right_;
};

}  // namespace modcal
