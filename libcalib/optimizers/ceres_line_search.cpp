#include "libcalib/optimizers/ceres_line_search.hpp"

#include <ceres/ceres.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <limits>

#include "libcalib/optimizers/ceres_convergence.hpp"
#include "libcalib/optimizers/tolerances.hpp"
#include "libcalib/optimizers/unbounded_search.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

constexpr std::array<std::string_view, 6> kDirections = {
    "bfgs", "fletcher_reeves", "hestenes_stiefel", "lbfgs", "polak_ribiere", "steepest_descent"};

class Function final : public ceres::FirstOrderFunction {
 public:
  explicit Function(UnboundedSearch& search) : search_(search) {}
  int NumParameters() const override { return static_cast<int>(search_.dimension()); }
  bool Evaluate(const double* const u, double* value, double* gradient) const override {
    const std::size_t n = search_.dimension();
    const auto trial = search_.try_evaluate({u, n}, {.value = value, .gradient = gradient});
    if (trial != Evaluator::Trial::kOver) {
      last_value_ = *value;
      return true;
    }
    // A failed evaluation makes Ceres retry, or give the line search up: a flat function ends it.
    // Its result is not used.
    *value = last_value_;
    if (gradient) std::fill_n(gradient, n, 0.0);
    return true;
  }

 private:
  UnboundedSearch& search_;
  mutable double last_value_ = 0.0;
};

class EndWithTheSearch final : public ceres::IterationCallback {
 public:
  explicit EndWithTheSearch(const UnboundedSearch& search) : search_(search) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& /*summary*/) override {
    return search_.stopped() ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }

 private:
  const UnboundedSearch& search_;
};

void set_direction(const std::string& direction, ceres::GradientProblemSolver::Options& settings) {
  settings.line_search_direction_type = ceres::NONLINEAR_CONJUGATE_GRADIENT;
  if (direction == "bfgs") settings.line_search_direction_type = ceres::BFGS;
  if (direction == "lbfgs") settings.line_search_direction_type = ceres::LBFGS;
  if (direction == "steepest_descent") {
    settings.line_search_direction_type = ceres::STEEPEST_DESCENT;
  }
  settings.nonlinear_conjugate_gradient_type = ceres::FLETCHER_REEVES;
  if (direction == "polak_ribiere") {
    settings.nonlinear_conjugate_gradient_type = ceres::POLAK_RIBIERE;
  }
  if (direction == "hestenes_stiefel") {
    settings.nonlinear_conjugate_gradient_type = ceres::HESTENES_STIEFEL;
  }
}

StopReason reason_of(const ceres::GradientProblemSolver::Summary& summary) {
  // A line search that fails has lost its descent in rounding errors.
  if (summary.termination_type == ceres::FAILURE) return StopReason::kRoundoff;
  return convergence_reason(summary);
}

}  // namespace

void CeresLineSearch::Options::visit(OptionVisitor& visitor) {
  visitor.text({.key = "direction",
                .meaning = "how the direction of a line search is chosen",
                .choices = {kDirections.begin(), kDirections.end()}},
               direction);
  visit_tolerances(visitor, gradient_tolerance, step_tolerance, value_tolerance);
}

CeresLineSearch::CeresLineSearch(const Options& options) : options_(options) {
  MODCAL_REQUIRE(
      std::find(kDirections.begin(), kDirections.end(), options.direction) != kDirections.end(),
      "unknown direction \"{}\": {} are available", options.direction,
      fmt::join(kDirections, ", "));
}

StopReason CeresLineSearch::search(Evaluator& evaluator) const {
  silence_ceres();
  UnboundedSearch unbounded(evaluator);
  const ceres::GradientProblem problem(new Function(unbounded));
  EndWithTheSearch end_with_the_search(unbounded);
  ceres::GradientProblemSolver::Options settings;
  set_direction(options_.direction, settings);
  settings.gradient_tolerance = options_.gradient_tolerance;
  settings.parameter_tolerance = options_.step_tolerance;
  settings.function_tolerance = options_.value_tolerance;
  settings.max_num_iterations = std::numeric_limits<int>::max();  // the evaluator's budget decides
  settings.logging_type = ceres::SILENT;
  settings.callbacks = {&end_with_the_search};
  std::vector<double> u = evaluator.start();
  // Conjugate directions that have lost their conjugacy end in small steps far from the minimum:
  // as long as a fresh start along the gradient gets on, the search is not over.
  double previous = std::numeric_limits<double>::infinity();
  while (true) {
    ceres::GradientProblemSolver::Summary summary;
    ceres::Solve(settings, problem, u.data(), &summary);
    const StopReason reason = reason_of(summary);
    const bool better = summary.final_cost < previous;
    if (reason != StopReason::kSmallStep || !better || unbounded.stopped()) return reason;
    previous = summary.final_cost;
  }
}

}  // namespace modcal
