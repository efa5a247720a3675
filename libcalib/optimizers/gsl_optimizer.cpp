#include "libcalib/optimizers/gsl_optimizer.hpp"

#include <fmt/ranges.h>
#include <gsl/gsl_errno.h>

#include <algorithm>
#include <array>
#include <mutex>

#include "libcalib/optimizers/gsl_searches.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

using Search = StopReason (*)(UnboundedSearch&, const GslOptimizer::Options&);

struct Algorithm {
  std::string_view name;
  Search search;
};

constexpr std::array kTable = {
    Algorithm{"brent", gsl_line},
    Algorithm{"conjugate_fr", gsl_descent},
    Algorithm{"conjugate_pr", gsl_descent},
    Algorithm{"ddogleg", gsl_least_squares},
    Algorithm{"dogleg", gsl_least_squares},
    Algorithm{"golden_section", gsl_line},
    Algorithm{"lm", gsl_least_squares},
    Algorithm{"lmaccel", gsl_least_squares},
    Algorithm{"nmsimplex", gsl_simplex},
    Algorithm{"nmsimplex2", gsl_simplex},
    Algorithm{"nmsimplex2rand", gsl_simplex},
    Algorithm{"quad_golden", gsl_line},
    Algorithm{"steepest_descent", gsl_descent},
    Algorithm{"subspace2d", gsl_least_squares},
    Algorithm{"vector_bfgs", gsl_descent},
    Algorithm{"vector_bfgs2", gsl_descent},
};

constexpr auto kNames = [] {
  std::array<std::string_view, kTable.size()> names;
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = kTable[i].name;
  return names;
}();

const Algorithm* find(std::string_view name) {
  const auto* found = std::find_if(kTable.begin(), kTable.end(),
                                   [&](const Algorithm& entry) { return entry.name == name; });
  return found == kTable.end() ? nullptr : found;
}

void switch_the_error_handler_off() {
  static std::once_flag once;
  std::call_once(once, [] { gsl_set_error_handler_off(); });
}

}  // namespace

std::span<const std::string_view> GslOptimizer::algorithms() { return kNames; }

void GslOptimizer::Options::visit(OptionVisitor& visitor) {
  visitor.text({.key = "algorithm",
                .meaning = "GSL's name of the algorithm",
                .choices = {kNames.begin(), kNames.end()}},
               algorithm);
  const auto tolerance = [&visitor](std::string_view key, std::string_view meaning, double& value) {
    visitor.number({.key = key, .meaning = meaning, .unit = "1", .range = Range::non_negative()},
                   value);
  };
  tolerance("gradient_tolerance", "norm of the scaled gradient at an optimum", gradient_tolerance);
  tolerance("step_tolerance", "smallest step, or size of a simplex or a bracket, scaled",
            step_tolerance);
  tolerance("value_tolerance", "smallest decrease, relative to the value", value_tolerance);
  visitor.number({.key = "initial_step",
                  .meaning = "first step, scaled",
                  .unit = "1",
                  .range = Range::positive()},
                 initial_step);
}

GslOptimizer::GslOptimizer(const Options& options) : options_(options) {
  MODCAL_REQUIRE(find(options.algorithm) != nullptr,
                 "GSL has no algorithm \"{}\" for this; usable: {}", options.algorithm,
                 fmt::join(kNames, ", "));
  MODCAL_REQUIRE(options.initial_step > 0.0, "initial step {:g} must be > 0", options.initial_step);
}

Capabilities GslOptimizer::needs() const {
  const Search family = find(options_.algorithm)->search;
  return {.gradient = family == gsl_descent, .least_squares = family == gsl_least_squares};
}

void GslOptimizer::require_feasible(const Evaluator& evaluator) const {
  const Search family = find(options_.algorithm)->search;
  MODCAL_REQUIRE(family != gsl_line || evaluator.dimension() == 1,
                 "GSL's {} searches along one variable, {} are free: free one parameter or take "
                 "another algorithm",
                 options_.algorithm, evaluator.dimension());
  MODCAL_REQUIRE(
      family != gsl_least_squares || evaluator.residual_count() >= evaluator.dimension(),
      "GSL's {} needs at least as many residuals as variables, there are {} and {}: free fewer "
      "parameters or take more data",
      options_.algorithm, evaluator.residual_count(), evaluator.dimension());
}

StopReason GslOptimizer::search(Evaluator& evaluator) const {
  switch_the_error_handler_off();
  UnboundedSearch unbounded(evaluator);
  return find(options_.algorithm)->search(unbounded, options_);
}

}  // namespace modcal
