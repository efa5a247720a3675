#include "libcalib/optimizers/ceres_optimizer.hpp"

#include <ceres/ceres.h>
#include <fmt/ranges.h>
#include <glog/logging.h>

#include <algorithm>
#include <array>
#include <limits>

#include "libcalib/optimizers/tolerances.hpp"
#include "libcalib/optimizers/unbounded_search.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

using Trial = Evaluator::Trial;

/// A choice of the user and what Ceres calls it.
struct Strategy {
  std::string_view name;
  ceres::TrustRegionStrategyType type;
  ceres::DoglegType dogleg;
};
constexpr std::array kStrategies = {
    Strategy{"levenberg_marquardt", ceres::LEVENBERG_MARQUARDT, ceres::TRADITIONAL_DOGLEG},
    Strategy{"dogleg", ceres::DOGLEG, ceres::TRADITIONAL_DOGLEG},
    Strategy{"subspace_dogleg", ceres::DOGLEG, ceres::SUBSPACE_DOGLEG}};

struct Direction {
  std::string_view name;
  ceres::LineSearchDirectionType type;
  ceres::NonlinearConjugateGradientType conjugacy;
};
constexpr std::array kDirections = {
    Direction{"bfgs", ceres::BFGS, ceres::FLETCHER_REEVES},
    Direction{"fletcher_reeves", ceres::NONLINEAR_CONJUGATE_GRADIENT, ceres::FLETCHER_REEVES},
    Direction{"hestenes_stiefel", ceres::NONLINEAR_CONJUGATE_GRADIENT, ceres::HESTENES_STIEFEL},
    Direction{"lbfgs", ceres::LBFGS, ceres::FLETCHER_REEVES},
    Direction{"polak_ribiere", ceres::NONLINEAR_CONJUGATE_GRADIENT, ceres::POLAK_RIBIERE},
    Direction{"steepest_descent", ceres::STEEPEST_DESCENT, ceres::FLETCHER_REEVES}};

template <typename Choices>
std::vector<std::string_view> names_of(const Choices& choices) {
  std::vector<std::string_view> names;
  for (const auto& choice : choices) names.push_back(choice.name);
  return names;
}

/// The choice of that name; throws InvalidInput for an unknown one.
template <typename Choices>
const auto& chosen(const Choices& choices, std::string_view name, std::string_view what) {
  const auto found = std::find_if(choices.begin(), choices.end(),
                                  [name](const auto& choice) { return choice.name == name; });
  MODCAL_REQUIRE(found != choices.end(), "unknown {} \"{}\": {} are available", what, name,
                 fmt::join(names_of(choices), ", "));
  return *found;
}

// All residuals as one block of one parameter block.
class Residuals final : public ceres::CostFunction {
 public:
  explicit Residuals(Evaluator& evaluator) : evaluator_(evaluator) {
    set_num_residuals(static_cast<int>(evaluator.residual_count()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(evaluator.dimension()));
  }
  bool Evaluate(const double* const* z, double* residuals, double** jacobians) const override {
    double* jacobian = jacobians ? jacobians[0] : nullptr;
    const std::size_t n = evaluator_.dimension();
    const Trial trial =
        evaluator_.try_evaluate({z[0], n}, {.residuals = residuals, .jacobian = jacobian});
    // A failed evaluation makes Ceres take a shorter step; where the search is over, a flat,
    // perfect fit ends it at once. Its result is not used.
    if (trial == Trial::kOver) {
      const std::size_t m = evaluator_.residual_count();
      std::fill_n(residuals, m, 0.0);
      if (jacobian) std::fill_n(jacobian, m * n, 0.0);
    }
    return trial != Trial::kRejected;
  }

 private:
  Evaluator& evaluator_;
};

class Function final : public ceres::FirstOrderFunction {
 public:
  explicit Function(UnboundedSearch& search) : search_(search) {}
  int NumParameters() const override { return static_cast<int>(search_.dimension()); }
  bool Evaluate(const double* const u, double* value, double* gradient) const override {
    const std::size_t n = search_.dimension();
    const Trial trial = search_.try_evaluate({u, n}, {.value = value, .gradient = gradient});
    // A failed evaluation makes Ceres give the line search up: a flat function ends the search. Its
    // result is not used.
    if (trial == Trial::kOver) {
      *value = last_value_;
      if (gradient) std::fill_n(gradient, n, 0.0);
    }
    last_value_ = *value;
    return true;
  }

 private:
  UnboundedSearch& search_;
  mutable double last_value_ = 0.0;
};

/// Ends a solver with the search or where the value no longer falls.
template <typename Search>
class EndOfSearch final : public ceres::IterationCallback {
 public:
  EndOfSearch(const Search& search, double value_tolerance)
      : search_(search), decreases_(value_tolerance) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
    if (search_.stopped()) return ceres::SOLVER_ABORT;
    if (summary.iteration == 0 || !summary.step_is_successful) return ceres::SOLVER_CONTINUE;
    return decreases_.are_small(summary.cost_change, summary.cost)
               ? ceres::SOLVER_TERMINATE_SUCCESSFULLY
               : ceres::SOLVER_CONTINUE;
  }

 private:
  const Search& search_;
  SmallDecreases decreases_;
};

/// What the options of both solvers have in common.
template <typename Settings, typename Options>
void set_ends(Settings& settings, const Options& options, ceres::IterationCallback& end) {
  settings.gradient_tolerance = options.gradient_tolerance;
  settings.parameter_tolerance = options.step_tolerance;
  settings.function_tolerance = 0.0;                              // EndOfSearch decides
  settings.max_num_iterations = std::numeric_limits<int>::max();  // the evaluator's budget decides
  settings.logging_type = ceres::SILENT;
  settings.callbacks = {&end};
  // Solvers write warnings to standard error (restarts of conjugate gradients, rounding) that the
  // stop reason tells better: off for the whole process from the first use on.
  static const bool once = [] {
    FLAGS_minloglevel = google::GLOG_FATAL;
    return true;
  }();
  static_cast<void>(once);
}

/// Why a solver that did not fail has ended: Ceres tells its kinds of convergence apart in its
/// message only.
template <typename Summary>
StopReason convergence_reason(const Summary& summary) {
  if (summary.termination_type == ceres::USER_SUCCESS) return StopReason::kSmallDecrease;
  if (summary.termination_type != ceres::CONVERGENCE) return StopReason::kNoProgress;
  if (summary.message.starts_with("Function tolerance")) return StopReason::kSmallDecrease;
  if (summary.message.starts_with("Parameter tolerance")) return StopReason::kSmallStep;
  return StopReason::kConverged;
}

}  // namespace

void CeresOptimizer::Options::visit(OptionVisitor& visitor) {
  visitor("strategy", "trust-region strategy", {.choices = names_of(kStrategies)}, strategy);
  visit_tolerances(visitor, gradient_tolerance, step_tolerance, value_tolerance);
  visitor("initial_radius", "first radius of the trust region, in scaled variables",
          {.range = Range::positive()}, initial_radius);
}

CeresOptimizer::CeresOptimizer(const Options& options) : options_(options) {
  chosen(kStrategies, options.strategy, "strategy");
}

StopReason CeresOptimizer::search(Evaluator& evaluator) const {
  ceres::Problem problem;
  std::vector<double> z = evaluator.start();
  problem.AddResidualBlock(new Residuals(evaluator), nullptr, z.data());
  for (std::size_t i = 0; i < z.size(); ++i) {
    problem.SetParameterLowerBound(z.data(), static_cast<int>(i), evaluator.lower()[i]);
    problem.SetParameterUpperBound(z.data(), static_cast<int>(i), evaluator.upper()[i]);
  }
  EndOfSearch end(evaluator, options_.value_tolerance);
  const Strategy& strategy = chosen(kStrategies, options_.strategy, "strategy");
  ceres::Solver::Options settings;
  set_ends(settings, options_, end);
  settings.trust_region_strategy_type = strategy.type;
  settings.dogleg_type = strategy.dogleg;
  settings.linear_solver_type = ceres::DENSE_QR;
  settings.initial_trust_region_radius = options_.initial_radius;
  settings.num_threads = 1;
  ceres::Solver::Summary summary;
  ceres::Solve(settings, &problem, &summary);
  return convergence_reason(summary);
}

void CeresLineSearch::Options::visit(OptionVisitor& visitor) {
  visitor("direction", "how the direction of a line search is chosen",
          {.choices = names_of(kDirections)}, direction);
  visit_tolerances(visitor, gradient_tolerance, step_tolerance, value_tolerance);
}

CeresLineSearch::CeresLineSearch(const Options& options) : options_(options) {
  chosen(kDirections, options.direction, "direction");
}

StopReason CeresLineSearch::search(Evaluator& evaluator) const {
  UnboundedSearch unbounded(evaluator);
  const ceres::GradientProblem problem(new Function(unbounded));
  EndOfSearch end(unbounded, options_.value_tolerance);
  const Direction& direction = chosen(kDirections, options_.direction, "direction");
  ceres::GradientProblemSolver::Options settings;
  set_ends(settings, options_, end);
  settings.line_search_direction_type = direction.type;
  settings.nonlinear_conjugate_gradient_type = direction.conjugacy;
  std::vector<double> u = evaluator.start();
  // Conjugate directions that have lost their conjugacy end in small steps far from the minimum:
  // as long as a fresh start along the gradient gets on, the search is not over.
  double previous = std::numeric_limits<double>::infinity();
  while (true) {
    ceres::GradientProblemSolver::Summary summary;
    ceres::Solve(settings, problem, u.data(), &summary);
    // A line search that fails has lost its descent in rounding errors.
    const StopReason reason = summary.termination_type == ceres::FAILURE
                                  ? StopReason::kRoundoff
                                  : convergence_reason(summary);
    const bool better = summary.final_cost < previous;
    if (reason != StopReason::kSmallStep || !better || unbounded.stopped()) return reason;
    previous = summary.final_cost;
  }
}

}  // namespace modcal
