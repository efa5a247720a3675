// Discrete ill-posed problems with known answers.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace modcal {

/// b = A x by the midpoint rule; `noise_free` is A times the exact solution. Kernels and solutions
/// as in Hansen, Regularization Tools 4.1 (2008).
struct IllPosedProblem {
  std::string name;
  double step = 0.0;  ///< distance of the samples of the solution
  Eigen::MatrixXd matrix;
  Eigen::VectorXd solution;
  Eigen::VectorXd noise_free;
};

/// One-dimensional image restoration (Shaw, 1972), n even.
IllPosedProblem shaw(Eigen::Index n);
/// Inverse heat equation with κ = 1 (Carasso, 1982; Hansen, 1994).
IllPosedProblem heat(Eigen::Index n);
/// Fredholm equation of Phillips (1962) on [−6, 6].
IllPosedProblem phillips(Eigen::Index n);
/// Second derivative, first example: Green's function of u'' on [0, 1], solution t (Delves and
/// Mohamed, 1985).
IllPosedProblem deriv2(Eigen::Index n);

std::vector<IllPosedProblem> ill_posed_problems(Eigen::Index n);

}  // namespace modcal
