// What optimizers of least squares say where there is nothing to square.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

#include "tests/libcalib/any_optimizer.hpp"
#include "tests/refusal.hpp"

namespace modcal::no_residuals_test {
namespace {

/// Says that it is a sum of squares, of nothing.
class NoResiduals final : public ObjectiveFunction {
 public:
  std::string_view name() const override { return "no_residuals"; }
  std::size_t dimension() const override { return 2; }
  Capabilities capabilities() const override { return {.gradient = true, .least_squares = true}; }
  mutable std::atomic<int> calls = 0;

 private:
  void do_evaluate(std::span<const double> /*x*/, const ObjectiveOutputs& outputs) const override {
    ++calls;
    if (outputs.value) *outputs.value = 0.0;
    if (outputs.gradient) std::fill_n(outputs.gradient, 2, 0.0);
  }
};

class OfNoSquares : public AnyOptimizer {};
INSTANTIATE_TEST_SUITE_P(All, OfNoSquares,
                         testing::ValuesIn(cases_where([](const OptimizerCase& one) {
                           return one.optimizer->needs().sum_of_squares();
                         })),
                         label_of);

TEST_P(OfNoSquares, RefusesAnEmptyListOfResiduals) {
  const NoResiduals function;
  EXPECT_THAT(refusal_of([&] { optimizer().minimize(function, box(0.0, 0.0, -1.0, 1.0), {}); }),
              testing::HasSubstr("\"no_residuals\" is empty: give it one or more"));
  EXPECT_EQ(function.calls, 0);
}

}  // namespace
}  // namespace modcal::no_residuals_test
