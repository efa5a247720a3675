// Fixture of tests that every optimizer has to pass.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "tests/libcalib/optimizer_cases.hpp"
#include "tests/libcalib/test_functions.hpp"

namespace modcal {

/// One optimizer with one of its algorithms.
class AnyOptimizer : public testing::TestWithParam<OptimizerCase> {
 protected:
  const Optimizer& optimizer() const { return *GetParam().optimizer; }
  Way way() const { return GetParam().way; }
  bool one_variable() const { return way() == Way::kLine; }
  // MLSL's own work grows with the square of its evaluations.
  Budget enough() const {
    return {.evaluations = GetParam().label.find("MLSL") < 20 ? 2000 : 20000};
  }
};

/// The cases that a test is about. What it is not about has no test, rather than one that returns.
template <typename Condition>
std::vector<OptimizerCase> cases_where(Condition holds) {
  std::vector<OptimizerCase> cases = optimizer_cases();
  std::erase_if(cases, [&](const OptimizerCase& one) { return !holds(one); });
  return cases;
}

inline std::string label_of(const testing::TestParamInfo<OptimizerCase>& info) {
  return info.param.label;
}

/// The first variable of a function of two, the other at rest.
class FirstVariable final : public ObjectiveFunction {
 public:
  FirstVariable(const ObjectiveFunction& function, double rest)
      : function_(function), rest_(rest) {}
  std::string_view name() const override { return "first_variable"; }
  std::size_t dimension() const override { return 1; }
  Capabilities capabilities() const override { return {}; }

 private:
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    if (outputs.value) *outputs.value = function_.value(std::array{x[0], rest_});
  }
  const ObjectiveFunction& function_;
  double rest_;
};

/// A function of two variables as an optimizer can take it: whole, or along the first variable.
class FunctionProblem {
 public:
  FunctionProblem(const ObjectiveFunction& function, std::vector<Variable> variables, bool line)
      : function_(function),
        line_(function, variables[1].initial),
        use_line_(line),
        variables_(std::move(variables)) {
    if (line) variables_.resize(1);
  }
  OptimizationResult minimize(const Optimizer& optimizer, const Budget& budget,
                              SecondsClock clock = steady_seconds()) const {
    const ObjectiveFunction& function = use_line_ ? line_ : function_;
    return optimizer.minimize(function, variables_, budget, std::move(clock));
  }
  double value(std::span<const double> x) const {
    return use_line_ ? line_.value(x) : function_.value(x);
  }

 private:
  const ObjectiveFunction& function_;
  FirstVariable line_;
  bool use_line_;
  std::vector<Variable> variables_;
};

}  // namespace modcal
