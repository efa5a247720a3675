#include "benchmarks/problems/ill_posed_problems.hpp"

#include <cmath>
#include <numbers>
#include <utility>

namespace modcal {
namespace {

constexpr double kPi = std::numbers::pi;

double midpoint(Eigen::Index i, double low, double step) {
  return low + (static_cast<double>(i) + 0.5) * step;
}

IllPosedProblem finished(std::string name, double step, Eigen::MatrixXd matrix,
                         Eigen::VectorXd solution) {
  Eigen::VectorXd data = matrix * solution;
  return {std::move(name), step, std::move(matrix), std::move(solution), std::move(data)};
}

double heat_solution(double t) {
  if (t < 2.0) return 0.75 * t * t / 4.0;
  if (t < 3.0) return 0.75 + (t - 2.0) * (3.0 - t);
  return t < 10.0 ? 0.75 * std::exp(-2.0 * (t - 3.0)) : 0.0;
}

}  // namespace

IllPosedProblem shaw(Eigen::Index n) {
  const double step = kPi / static_cast<double>(n);
  Eigen::MatrixXd matrix(n, n);
  Eigen::VectorXd solution(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const double t = midpoint(j, -0.5 * kPi, step);
    solution[j] =
        2.0 * std::exp(-6.0 * (t - 0.8) * (t - 0.8)) + std::exp(-2.0 * (t + 0.5) * (t + 0.5));
    for (Eigen::Index i = 0; i < n; ++i) {
      const double s = midpoint(i, -0.5 * kPi, step);
      const double u = kPi * (std::sin(s) + std::sin(t));
      const double slit = std::abs(u) > 1e-12 ? std::sin(u) / u : 1.0;
      const double factor = (std::cos(s) + std::cos(t)) * slit;
      matrix(i, j) = step * factor * factor;
    }
  }
  return finished("shaw", step, std::move(matrix), std::move(solution));
}

IllPosedProblem heat(Eigen::Index n) {
  const double step = 1.0 / static_cast<double>(n);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd solution(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    solution[i] = heat_solution(20.0 * static_cast<double>(i + 1) * step);
    for (Eigen::Index j = 0; j <= i; ++j) {
      const double t = midpoint(i - j, 0.0, step);
      matrix(i, j) = step * std::exp(-0.25 / t) / (2.0 * std::sqrt(kPi) * t * std::sqrt(t));
    }
  }
  return finished("heat", step, std::move(matrix), std::move(solution));
}

IllPosedProblem phillips(Eigen::Index n) {
  const double step = 12.0 / static_cast<double>(n);
  const auto bell = [](double x) {
    return std::abs(x) < 3.0 ? 1.0 + std::cos(kPi * x / 3.0) : 0.0;
  };
  Eigen::MatrixXd matrix(n, n);
  Eigen::VectorXd solution(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const double t = midpoint(j, -6.0, step);
    solution[j] = bell(t);
    for (Eigen::Index i = 0; i < n; ++i) matrix(i, j) = step * bell(midpoint(i, -6.0, step) - t);
  }
  return finished("phillips", step, std::move(matrix), std::move(solution));
}

IllPosedProblem deriv2(Eigen::Index n) {
  const double step = 1.0 / static_cast<double>(n);
  Eigen::MatrixXd matrix(n, n);
  Eigen::VectorXd solution(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const double t = midpoint(j, 0.0, step);
    solution[j] = t;
    for (Eigen::Index i = 0; i < n; ++i) {
      const double s = midpoint(i, 0.0, step);
      matrix(i, j) = step * (s < t ? s * (t - 1.0) : t * (s - 1.0));
    }
  }
  return finished("deriv2", step, std::move(matrix), std::move(solution));
}

std::vector<IllPosedProblem> ill_posed_problems(Eigen::Index n) {
  return {shaw(n), heat(n), phillips(n), deriv2(n)};
}

}  // namespace modcal
