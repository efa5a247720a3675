#include "libcalib/optimizers/staged/staged.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "libcalib/problem/restricted_function.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

// "f" and "zeta" name every f_n and zeta_n; no number follows other names.
bool names(const std::string& free, const std::string& variable) {
  return variable == free ||
         (variable.starts_with(free + "_") &&
          variable.find_first_not_of("0123456789", free.size() + 1) == std::string::npos);
}

// Where the variables stand that a stage frees.
std::vector<std::size_t> places_of(const Staged::Stage& stage,
                                   std::span<const Variable> variables) {
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < variables.size(); ++i) {
    const bool free = stage.free.empty() ||
                      std::any_of(stage.free.begin(), stage.free.end(),
                                  [&](const auto& name) { return names(name, variables[i].name); });
    if (free) places.push_back(i);
  }
  return places;
}

}  // namespace

void Staged::Stage::visit(OptionVisitor& visitor) {
  visitor("damping",
          "the record is multiplied by exp(-damping t): wide basins; 0: the "
          "record itself",
          {.unit = "Hz", .range = Range::non_negative()}, damping);
  visitor("free",
          "parameters searched, of those that are free; f: every f_n, zeta: every "
          "zeta_n; none named: all",
          free);
  visitor("optimizer", "how the stage is searched", optimizer);
}

void Staged::Options::visit(OptionVisitor& visitor) {
  visitor("stages", "searched one after the other; none: the schedule of the objective", stages);
  visitor("restarts",
          "other starts tried while the fit is contradicted by the data, in the "
          "schedule of the objective",
          {.range = Range::closed(0.0, 4.0)}, schedule.restarts);
}

Staged::Staged(Options options) : options_(std::move(options)) {
  for (const Stage& stage : options_.stages) {
    MODCAL_REQUIRE(stage.damping >= 0.0, "damping {:g} 1/s must be >= 0", stage.damping);
  }
}

Capabilities Staged::needs() const {
  Capabilities all{.schedule = options_.stages.empty()};
  for (const Stage& stage : options_.stages) {
    const Capabilities one = stage.optimizer.make()->needs();
    all.gradient = all.gradient || one.gradient;
    all.least_squares = all.least_squares || one.least_squares;
    all.residuals = all.residuals || one.residuals;
    all.information = all.information || one.information;
    all.damped = all.damped || stage.damping > 0.0;
  }
  return all;
}

void Staged::require_feasible(const Evaluator& evaluator) const {
  for (const Stage& stage : options_.stages) {
    for (const std::string& name : stage.free) {
      const auto& variables = evaluator.variables();
      MODCAL_REQUIRE(
          std::any_of(variables.begin(), variables.end(),
                      [&](const Variable& v) { return names(name, v.name); }),
          "a stage frees \"{}\", which is none of the parameters searched: free it under "
          "parameters, or leave it out",
          name);
    }
  }
}

StopReason Staged::search(Evaluator& evaluator) const {
  const ObjectiveFunction& whole = evaluator.function();
  if (options_.stages.empty()) return whole.follow_schedule(evaluator, options_.schedule);
  const std::span<const Variable> all = evaluator.variables();
  std::vector<double> x;
  for (const Variable& variable : all) x.push_back(variable.initial);
  StopReason reason = StopReason::kNotRun;
  for (const Stage& stage : options_.stages) {
    const std::vector<std::size_t> places = places_of(stage, all);
    std::vector<Variable> variables;
    for (const std::size_t i : places) {
      variables.push_back(all[i]);
      variables.back().initial = x[i];
    }
    const auto damped = stage.damping > 0.0 ? whole.damped(stage.damping) : nullptr;
    const RestrictedFunction function(damped ? *damped : whole, x, places);
    Evaluator inner(evaluator, function, variables, damped ? std::vector<std::size_t>() : places,
                    x);
    const OptimizationResult found = stage.optimizer.make()->minimize(inner);
    for (std::size_t i = 0; i < places.size(); ++i) x[places[i]] = found.x[i];
    evaluator.end_stage(
        {.name =
             fmt::format("{}, {}, damping = {:.3g} 1/s", stage.optimizer.selected(),
                         stage.free.empty() ? "all" : fmt::format("{}", fmt::join(stage.free, " ")),
                         stage.damping),
         .evaluations = static_cast<std::size_t>(evaluator.evaluations()),
         .objective = found.value});
    reason = found.stop;
    if (reason == StopReason::kTargetReached || reason == StopReason::kTimeBudget ||
        reason == StopReason::kEvaluationBudget) {
      return reason;
    }
  }
  if (options_.stages.back().damping > 0.0) {
    std::vector<double> z;
    for (std::size_t i = 0; i < x.size(); ++i) z.push_back((x[i] - all[i].initial) / all[i].scale);
    evaluator.value(z);
  }
  return reason;
}

}  // namespace modcal
