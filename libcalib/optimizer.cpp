#include "libcalib/optimizer.hpp"

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

bool satisfied(const Capabilities& needs, const Capabilities& has) {
  return (has.gradient || !needs.gradient) && (has.least_squares || !needs.least_squares);
}

std::string optimizers_for(const Capabilities& has) {
  std::string names;
  for (const auto& entry : Optimizer::registry()) {
    if (!satisfied(entry.recipe()->make()->needs(), has)) continue;
    if (!names.empty()) names += ", ";
    names += entry.name;
  }
  return names;
}

}  // namespace

std::string Optimizer::explain_unsatisfied(const ObjectiveFunction& function) const {
  const Capabilities needed = needs();
  const Capabilities known = function.capabilities();
  if (satisfied(needed, known)) return {};
  const bool residuals_missing = needed.least_squares && !known.least_squares;
  return fmt::format(
      "optimizer \"{}\" needs {}, which objective \"{}\" does not have; with their default options "
      "these optimizers can minimize it: {}",
      name(), residuals_missing ? "residuals with their Jacobian" : "a gradient", function.name(),
      optimizers_for(known));
}

OptimizationResult Optimizer::minimize(const ObjectiveFunction& function,
                                       std::span<const Variable> variables, const Budget& budget,
                                       SecondsClock clock) const {
  const std::string mismatch = explain_unsatisfied(function);
  MODCAL_REQUIRE(mismatch.empty(), "{}", mismatch);
  Evaluator evaluator(function, variables, budget, std::move(clock));
  require_feasible(evaluator);
  StopReason reason = StopReason::kNotRun;
  try {
    evaluator.begin();
    reason = search(evaluator);
  } catch (const Evaluator::Stopped&) {
  }
  return evaluator.finish(reason);
}

}  // namespace modcal
