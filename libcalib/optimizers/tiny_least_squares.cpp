#include "libcalib/optimizers/tiny_least_squares.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "libcalib/optimizers/tolerances.hpp"
#include "libcalib/optimizers/tuning.hpp"
#include "libcalib/optimizers/unbounded_search.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

/// All memory of one search.
struct Workspace {
  Workspace(std::size_t residual_count, std::size_t n)
      : residuals(residual_count),
        trial_residuals(residual_count),
        jacobian(residual_count * n),
        u(Eigen::VectorXd::Zero(static_cast<Eigen::Index>(n))),
        trial(u),
        gradient(u),
        step(u),
        normal(u.size(), u.size()),
        damped(u.size(), u.size()),
        factors(u.size()) {}

  std::vector<double> residuals, trial_residuals, jacobian;
  Eigen::VectorXd u, trial, gradient, step;
  Eigen::MatrixXd normal, damped;
  Eigen::LLT<Eigen::MatrixXd> factors;
};

// Row by row: Eigen's product of large matrices allocates.
void form_normal_equations(Workspace& work) {
  const Eigen::Index n = work.u.size();
  work.normal.setZero();
  work.gradient.setZero();
  const double* row = work.jacobian.data();
  for (const double r : work.residuals) {
    for (Eigen::Index i = 0; i < n; ++i) {
      work.gradient[i] += row[i] * r;
      for (Eigen::Index k = 0; k <= i; ++k) work.normal(i, k) += row[i] * row[k];
    }
    row += n;
  }
}

/// Solves the damped normal equations for the step; false where rounding forbids it.
bool solve_for_step(Workspace& work, double damping) {
  const double largest = work.normal.diagonal().maxCoeff();
  work.damped = work.normal;
  for (Eigen::Index i = 0; i < work.u.size(); ++i) {
    // A column of zeros would leave its variable undamped.
    work.damped(i, i) += damping * std::max(work.normal(i, i), 1e-12 * largest);
  }
  work.factors.compute(work.damped);
  if (work.factors.info() != Eigen::Success) return false;
  work.step = -work.gradient;
  work.factors.solveInPlace(work.step);
  return work.step.allFinite();
}

double half_square(const std::vector<double>& residuals) {
  double sum = 0.0;
  for (const double r : residuals) sum += 0.5 * r * r;
  return sum;
}

std::span<const double> span_of(const Eigen::VectorXd& vector) {
  return {vector.data(), static_cast<std::size_t>(vector.size())};
}

}  // namespace

void TinyLeastSquares::Options::visit(OptionVisitor& visitor) {
  visit_tolerances(visitor, gradient_tolerance, step_tolerance, value_tolerance);
  visitor("initial_damping", "first damping, relative to the diagonal of the normal equations",
          {.range = Range::positive()}, initial_damping);
}

TinyLeastSquares::TinyLeastSquares(const Options& options) : options_(options) {
  MODCAL_REQUIRE(options.initial_damping > 0.0, "initial damping {:g} must be > 0",
                 options.initial_damping);
}

StopReason TinyLeastSquares::search(Evaluator& evaluator) const {
  UnboundedSearch unbounded(evaluator);
  Workspace work(evaluator.residual_count(), evaluator.dimension());
  double damping = options_.initial_damping;
  double growth = 2.0;
  bool moved = true;
  double value = 0.0;
  SmallDecreases decreases(options_.value_tolerance);
  while (damping < kHopelessDamping) {
    if (moved) {
      const auto trial = unbounded.try_evaluate(
          span_of(work.u), {.residuals = work.residuals.data(), .jacobian = work.jacobian.data()});
      if (trial != Evaluator::Trial::kFinite) return StopReason::kNoProgress;
      value = half_square(work.residuals);
      form_normal_equations(work);
    }
    if (work.gradient.lpNorm<Eigen::Infinity>() <= options_.gradient_tolerance) {
      return StopReason::kConverged;
    }
    moved = false;
    if (solve_for_step(work, damping)) {
      const double small = options_.step_tolerance * (work.u.norm() + options_.step_tolerance);
      if (work.step.norm() <= small) return StopReason::kSmallStep;
      work.trial = work.u + work.step;
      const auto trial =
          unbounded.try_evaluate(span_of(work.trial), {.residuals = work.trial_residuals.data()});
      if (trial == Evaluator::Trial::kOver) return StopReason::kNoProgress;
      const double decrease = value - half_square(work.trial_residuals);
      // ½ δᵀ(μ D δ − g) with (JᵀJ + μ D) δ = −g.
      double predicted = -0.5 * work.step.dot(work.gradient);
      for (Eigen::Index i = 0; i < work.u.size(); ++i) {
        const double added = work.damped(i, i) - work.normal(i, i);
        predicted += 0.5 * added * work.step[i] * work.step[i];
      }
      moved = decrease > 0.0;
      if (moved) work.u = work.trial;
      if (decreases.are_small(std::abs(decrease), value)) return StopReason::kSmallDecrease;
      const double ratio = 2.0 * decrease / predicted - 1.0;
      if (moved) damping *= std::max(1.0 / 3.0, 1.0 - ratio * ratio * ratio);
    }
    if (moved) {
      growth = 2.0;
    } else {
      damping *= growth;
      growth *= 2.0;
    }
  }
  return StopReason::kRoundoff;
}

}  // namespace modcal
