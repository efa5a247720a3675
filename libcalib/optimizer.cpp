#include "libcalib/optimizer.hpp"

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// A gradient or a Jacobian that the objective does not give is formed by differences; residuals
// cannot be made up.
bool satisfied(const Capabilities& needs, const Capabilities& has) {
  return has.sum_of_squares() || !needs.sum_of_squares();
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
  return explain_unsatisfied(function.name(), function.capabilities());
}

std::string Optimizer::explain_unsatisfied(std::string_view objective,
                                           const Capabilities& known) const {
  if (satisfied(needs(), known)) return {};
  return fmt::format(
      "optimizer \"{}\" needs residuals, which objective \"{}\" does not have: it is no sum of "
      "squares; with their default options these optimizers can minimize it: {}",
      name(), objective, optimizers_for(known));
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
