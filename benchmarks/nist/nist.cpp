// nist FOLDER [values]: digits that the optimizers reach on NIST's certified problems from both
// starts, with the defaults of the adapters and 20 000 evaluations. With `values` the objective
// keeps its residuals without derivatives, which the evaluator then forms by differences.
#include <fmt/format.h>

#include <cstdio>
#include <memory>

#include "benchmarks/nist/nist_problems.hpp"
#include "libcalib/optimizers/ceres_optimizer.hpp"
#include "libcalib/optimizers/gsl_optimizer.hpp"
#include "libcalib/optimizers/nlopt_optimizer.hpp"
#include "libcalib/optimizers/tiny_least_squares.hpp"

namespace modcal {
namespace {

struct Method {
  std::string_view name;
  std::unique_ptr<const Optimizer> optimizer;
  int solved = 0;
};

/// The residuals of another function, without derivatives.
class Residuals final : public ObjectiveFunction {
 public:
  explicit Residuals(const ObjectiveFunction& function) : function_(function) {}
  std::string_view name() const override { return function_.name(); }
  std::size_t dimension() const override { return function_.dimension(); }
  std::size_t residual_count() const override { return function_.residual_count(); }
  Capabilities capabilities() const override { return {.residuals = true}; }

 private:
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    function_.evaluate(x, outputs);
  }
  const ObjectiveFunction& function_;
};

std::vector<Method> methods() {
  std::vector<Method> list;
  const auto add = [&list](std::string_view name, auto optimizer) {
    list.push_back({name, std::make_unique<decltype(optimizer)>(std::move(optimizer))});
  };
  add("Ceres", CeresOptimizer({}));
  add("GSL lm", GslOptimizer({.algorithm = "lm"}));
  add("tiny", TinyLeastSquares(TinyLeastSquares::Options{}));
  add("SLSQP", NloptOptimizer({.algorithm = "LD_SLSQP"}));
  add("L-BFGS", NloptOptimizer({.algorithm = "LD_LBFGS"}));
  return list;
}

void print_table(const std::string& folder, bool differences) {
  constexpr double kSolved = 6.0;
  constexpr Budget kBudget{.evaluations = 20000};
  std::vector<Method> list = methods();
  fmt::print("{:<10}", "digits");
  for (const Method& method : list) fmt::print(" {:>24}", method.name);
  for (const std::string_view name : nist_names()) {
    const NistProblem problem(folder, name);
    const Residuals residuals(problem);
    const ObjectiveFunction& function =
        differences ? static_cast<const ObjectiveFunction&>(residuals) : problem;
    for (const int start : {1, 2}) {
      fmt::print("\n{:<8} {}", name, start);
      for (Method& method : list) {
        const auto result = method.optimizer->minimize(function, problem.variables(start), kBudget);
        const double digits = problem.digits(result.x);
        method.solved += digits >= kSolved;
        fmt::print(" {:>4.1f} {:>13} {:>5}", digits, name_of(result.stop), result.evaluations);
        std::fflush(stdout);
      }
    }
  }
  fmt::print("\n{:<10}", ">= 6 of 54");
  for (const Method& method : list) fmt::print(" {:>24}", method.solved);
  fmt::print("\n");
}

}  // namespace
}  // namespace modcal

int main(int argc, char** argv) {
  if (argc < 2) return fmt::print(stderr, "usage: nist FOLDER [values]\n"), 2;
  modcal::print_table(argv[1], argc > 2);
  return 0;
}
