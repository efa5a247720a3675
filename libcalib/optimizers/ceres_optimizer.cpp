#include "libcalib/optimizers/ceres_optimizer.hpp"

#include <ceres/ceres.h>

#include <algorithm>
#include <limits>

#include "libcalib/optimizers/ceres_convergence.hpp"
#include "libcalib/optimizers/tolerances.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// All residuals as one block of one parameter block.
class Residuals final : public ceres::CostFunction {
 public:
  explicit Residuals(Evaluator& evaluator) : evaluator_(evaluator) {
    set_num_residuals(static_cast<int>(evaluator.residual_count()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(evaluator.dimension()));
  }
  bool Evaluate(const double* const* parameters, double* residuals,
                double** jacobians) const override {
    double* jacobian = jacobians ? jacobians[0] : nullptr;
    const std::size_t n = evaluator_.dimension();
    const std::size_t m = evaluator_.residual_count();
    const auto trial =
        evaluator_.try_evaluate({parameters[0], n}, {.residuals = residuals, .jacobian = jacobian});
    if (trial == Evaluator::Trial::kFinite) return true;
    if (trial == Evaluator::Trial::kRejected) return false;  // Ceres takes a shorter step
    // A failed evaluation makes Ceres go on: a flat, perfect fit ends it. Its result is not used.
    std::fill_n(residuals, m, 0.0);
    if (jacobian) std::fill_n(jacobian, m * n, 0.0);
    return true;
  }

 private:
  Evaluator& evaluator_;
};

class EndWithTheEvaluator final : public ceres::IterationCallback {
 public:
  explicit EndWithTheEvaluator(const Evaluator& evaluator) : evaluator_(evaluator) {}
  ceres::CallbackReturnType operator()(const ceres::IterationSummary& /*summary*/) override {
    return evaluator_.stopped() ? ceres::SOLVER_ABORT : ceres::SOLVER_CONTINUE;
  }

 private:
  const Evaluator& evaluator_;
};

}  // namespace

void CeresOptimizer::Options::visit(OptionVisitor& visitor) {
  visitor.text({.key = "strategy",
                .meaning = "trust-region strategy",
                .choices = {"levenberg_marquardt", "dogleg", "subspace_dogleg"}},
               strategy);
  visit_tolerances(visitor, gradient_tolerance, step_tolerance, value_tolerance);
  visitor.number({.key = "initial_radius",
                  .meaning = "first radius of the trust region, in scaled variables",
                  .unit = "1",
                  .range = Range::positive()},
                 initial_radius);
}

CeresOptimizer::CeresOptimizer(const Options& options) : options_(options) {
  MODCAL_REQUIRE(options.strategy == "levenberg_marquardt" || options.strategy == "dogleg" ||
                     options.strategy == "subspace_dogleg",
                 "unknown strategy \"{}\": levenberg_marquardt, dogleg and subspace_dogleg are "
                 "available",
                 options.strategy);
}

StopReason CeresOptimizer::search(Evaluator& evaluator) const {
  silence_ceres();
  ceres::Problem problem;
  std::vector<double> z = evaluator.start();
  problem.AddResidualBlock(new Residuals(evaluator), nullptr, z.data());
  for (std::size_t i = 0; i < z.size(); ++i) {
    problem.SetParameterLowerBound(z.data(), static_cast<int>(i), evaluator.lower()[i]);
    problem.SetParameterUpperBound(z.data(), static_cast<int>(i), evaluator.upper()[i]);
  }
  EndWithTheEvaluator end_with_the_evaluator(evaluator);
  ceres::Solver::Options settings;
  settings.trust_region_strategy_type =
      options_.strategy == "levenberg_marquardt" ? ceres::LEVENBERG_MARQUARDT : ceres::DOGLEG;
  settings.dogleg_type =
      options_.strategy == "subspace_dogleg" ? ceres::SUBSPACE_DOGLEG : ceres::TRADITIONAL_DOGLEG;
  settings.linear_solver_type = ceres::DENSE_QR;
  settings.gradient_tolerance = options_.gradient_tolerance;
  settings.parameter_tolerance = options_.step_tolerance;
  settings.function_tolerance = options_.value_tolerance;
  settings.initial_trust_region_radius = options_.initial_radius;
  settings.max_num_iterations = std::numeric_limits<int>::max();  // the evaluator's budget decides
  settings.num_threads = 1;
  settings.logging_type = ceres::SILENT;
  settings.callbacks = {&end_with_the_evaluator};
  ceres::Solver::Summary summary;
  ceres::Solve(settings, &problem, &summary);
  return convergence_reason(summary);
}

}  // namespace modcal
