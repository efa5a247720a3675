#include "libcalib/optimizers/gsl_optimizer.hpp"

#include <fmt/ranges.h>
#include <gsl/gsl_errno.h>

#include <algorithm>
#include <array>
#include <mutex>
#include <variant>

#include "libcalib/optimizers/gsl_searches.hpp"
#include "libcalib/optimizers/tolerances.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

/// The library's table of an algorithm, behind the address at which it stands.
using Table = std::variant<const GslSimplex* const*, const GslDescent* const*,
                           const GslTrustRegion* const*, const GslLine* const*>;

struct Algorithm {
  std::string_view name;
  Table table;

  template <typename Family>
  bool is() const {
    return std::holds_alternative<const Family* const*>(table);
  }
};

constexpr std::array kAlgorithms = {
    Algorithm{"brent", &gsl_min_fminimizer_brent},
    Algorithm{"conjugate_fr", &gsl_multimin_fdfminimizer_conjugate_fr},
    Algorithm{"conjugate_pr", &gsl_multimin_fdfminimizer_conjugate_pr},
    Algorithm{"ddogleg", &gsl_multifit_nlinear_trs_ddogleg},
    Algorithm{"dogleg", &gsl_multifit_nlinear_trs_dogleg},
    Algorithm{"golden_section", &gsl_min_fminimizer_goldensection},
    Algorithm{"lm", &gsl_multifit_nlinear_trs_lm},
    Algorithm{"lmaccel", &gsl_multifit_nlinear_trs_lmaccel},
    Algorithm{"nmsimplex", &gsl_multimin_fminimizer_nmsimplex},
    Algorithm{"nmsimplex2", &gsl_multimin_fminimizer_nmsimplex2},
    Algorithm{"nmsimplex2rand", &gsl_multimin_fminimizer_nmsimplex2rand},
    Algorithm{"quad_golden", &gsl_min_fminimizer_quad_golden},
    Algorithm{"steepest_descent", &gsl_multimin_fdfminimizer_steepest_descent},
    Algorithm{"subspace2d", &gsl_multifit_nlinear_trs_subspace2D},
    Algorithm{"vector_bfgs", &gsl_multimin_fdfminimizer_vector_bfgs},
    Algorithm{"vector_bfgs2", &gsl_multimin_fdfminimizer_vector_bfgs2},
};

constexpr auto kNames = [] {
  std::array<std::string_view, kAlgorithms.size()> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = kAlgorithms[i].name;
  return names;
}();

const Algorithm* find(std::string_view name) {
  const auto* found = std::find_if(kAlgorithms.begin(), kAlgorithms.end(),
                                   [&](const Algorithm& entry) { return entry.name == name; });
  return found == kAlgorithms.end() ? nullptr : found;
}

}  // namespace

std::span<const std::string_view> GslOptimizer::algorithms() { return kNames; }

void GslOptimizer::Options::visit(OptionVisitor& visitor) {
  visitor("algorithm", "GSL's name of the algorithm", {.choices = {kNames.begin(), kNames.end()}},
          algorithm);
  visit_tolerances(visitor, gradient_tolerance, step_tolerance, value_tolerance);
  visitor("initial_step", "first step, scaled", {.range = Range::positive()}, initial_step);
}

GslOptimizer::GslOptimizer(const Options& options) : options_(options) {
  MODCAL_REQUIRE(find(options.algorithm) != nullptr,
                 "GSL has no algorithm \"{}\" for this; usable: {}", options.algorithm,
                 fmt::join(kNames, ", "));
  MODCAL_REQUIRE(options.initial_step > 0.0, "initial step {:g} must be > 0", options.initial_step);
}

Capabilities GslOptimizer::needs() const {
  const Algorithm* algorithm = find(options_.algorithm);
  return {.gradient = algorithm->is<GslDescent>(),
          .least_squares = algorithm->is<GslTrustRegion>()};
}

void GslOptimizer::require_feasible(const Evaluator& evaluator) const {
  const Algorithm* algorithm = find(options_.algorithm);
  MODCAL_REQUIRE(!algorithm->is<GslLine>() || evaluator.dimension() == 1,
                 "GSL's {} searches along one variable, {} are free: free one parameter or take "
                 "another algorithm",
                 options_.algorithm, evaluator.dimension());
  MODCAL_REQUIRE(
      !algorithm->is<GslTrustRegion>() || evaluator.residual_count() >= evaluator.dimension(),
      "GSL's {} needs at least as many residuals as variables, there are {} and {}: free fewer "
      "parameters or take more data",
      options_.algorithm, evaluator.residual_count(), evaluator.dimension());
}

StopReason GslOptimizer::search(Evaluator& evaluator) const {
  static std::once_flag once;
  std::call_once(once, [] { gsl_set_error_handler_off(); });
  UnboundedSearch unbounded(evaluator);
  return std::visit([&](auto table) { return gsl_search(*table, unbounded, options_); },
                    find(options_.algorithm)->table);
}

}  // namespace modcal
