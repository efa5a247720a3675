// Optimizers: how an objective is minimized.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "libcalib/problem/evaluator.hpp"
#include "libsim/base/registry.hpp"

namespace modcal {

class Optimizer {
 public:
  static constexpr std::string_view kKind = "optimizer";
  static Registry<Optimizer> registry();
  /// One of the program's own, which experiments choose by its name from now on; it has no options.
  /// Throws InvalidInput for a name that is taken.
  static void add(std::string name, std::string summary, std::shared_ptr<const Optimizer> product);

  virtual ~Optimizer() = default;
  virtual std::string_view name() const = 0;
  /// What the objective must be able to compute.
  virtual Capabilities needs() const { return {}; }

  /// Why this optimizer cannot minimize the objective, with a remedy; empty where it can.
  std::string explain_unsatisfied(const ObjectiveFunction& function) const;
  /// The same for an objective of that name that can compute so much.
  std::string explain_unsatisfied(std::string_view objective, const Capabilities& known) const;

  /// Minimizes the function within the bounds of the variables, from their initial values. Throws
  /// InvalidInput where explain_unsatisfied() has something to say, before the first evaluation,
  /// and what the objective throws.
  OptimizationResult minimize(const ObjectiveFunction& function,
                              std::span<const Variable> variables, const Budget& budget,
                              SecondsClock clock = steady_seconds()) const;
  /// The same through an evaluator that is there: a stage of another search.
  OptimizationResult minimize(Evaluator& evaluator) const;

 private:
  /// Whether the value at the initial point is wanted before the search.
  virtual bool starts_from_value() const { return true; }
  /// Throws InvalidInput where the search cannot be made within the bounds or the budget; called
  /// before the first evaluation.
  virtual void require_feasible(const Evaluator& /*evaluator*/) const {}
  /// Searches through the evaluator, which has evaluated the initial point, and says why it ended.
  virtual StopReason search(Evaluator& evaluator) const = 0;
};

}  // namespace modcal
