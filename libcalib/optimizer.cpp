#include "libcalib/optimizer.hpp"

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// A gradient or a Jacobian that the objective does not give is formed by differences; residuals and
// the rest cannot be made up.
bool satisfied(const Capabilities& needs, const Capabilities& has) {
  return (has.sum_of_squares() || !needs.sum_of_squares()) &&
         (has.information || !needs.information) && (has.damped || !needs.damped) &&
         (has.schedule || !needs.schedule);
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
  const Capabilities known = function.capabilities();
  if (needs().sum_of_squares() && known.sum_of_squares() && function.residual_count() == 0) {
    return fmt::format(
        "optimizer \"{}\" needs residuals, and the list of those of objective \"{}\" is empty: "
        "give it one or more",
        name(), function.name());
  }
  return explain_unsatisfied(function.name(), known);
}

std::string Optimizer::explain_unsatisfied(std::string_view objective,
                                           const Capabilities& known) const {
  if (satisfied(needs(), known)) return {};
  const Capabilities wanted = needs();
  std::string reason;
  if (wanted.sum_of_squares() && !known.sum_of_squares()) {
    reason = fmt::format(
        "needs residuals, which objective \"{}\" does not have: it is no sum of squares",
        objective);
  } else if (wanted.information && !known.information) {
    reason = fmt::format("needs the Fisher information, which objective \"{}\" does not have",
                         objective);
  } else if (wanted.damped && !known.damped) {
    reason = fmt::format(
        "damps the record, and objective \"{}\" has no form for that: state damping: 0, or take "
        "objective joint_likelihood",
        objective);
  } else {
    reason = fmt::format(
        "without stages follows the schedule of the objective, and \"{}\" has none: state its "
        "stages, or take objective joint_likelihood",
        objective);
  }
  return fmt::format(
      "optimizer \"{}\" {}; with their default options these optimizers can minimize it: {}",
      name(), reason, optimizers_for(known));
}

OptimizationResult Optimizer::minimize(const ObjectiveFunction& function,
                                       std::span<const Variable> variables, const Budget& budget,
                                       SecondsClock clock) const {
  Evaluator evaluator(function, variables, budget, std::move(clock));
  return minimize(evaluator);
}

OptimizationResult Optimizer::minimize(Evaluator& evaluator) const {
  const std::string mismatch = explain_unsatisfied(evaluator.function());
  MODCAL_REQUIRE(mismatch.empty(), "{}", mismatch);
  require_feasible(evaluator);
  StopReason reason = StopReason::kNotRun;
  try {
    if (starts_from_value()) evaluator.begin();
    reason = search(evaluator);
  } catch (const Evaluator::Stopped&) {
  }
  return evaluator.finish(reason);
}

}  // namespace modcal
