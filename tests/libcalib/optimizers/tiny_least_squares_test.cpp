// The search allocates nothing between its first evaluation and its last.
#include "libcalib/optimizers/tiny_least_squares.hpp"

#include <gtest/gtest.h>

#include "libsim/base/error.hpp"
#include "tests/allocations.hpp"
#include "tests/libcalib/test_functions.hpp"

namespace modcal::tiny_least_squares_test {
namespace {

/// The damped sinusoids, noting how many allocations there had been at every evaluation.
class Noting final : public ObjectiveFunction {
 public:
  std::string_view name() const override { return "noting"; }
  std::size_t dimension() const override { return inner_.dimension(); }
  std::size_t residual_count() const override { return inner_.residual_count(); }
  Capabilities capabilities() const override { return inner_.capabilities(); }
  mutable int calls = 0;
  mutable std::size_t after_third = 0;
  mutable std::size_t last = 0;

 private:
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    inner_.evaluate(x, outputs);
    // The first evaluation is the evaluator's, the second the search's own.
    if (++calls == 3) after_third = allocations();
    last = allocations();
  }
  DampedSinusoids inner_;
};

TEST(TinyLeastSquares, AllocatesNothingAfterItsFirstStep) {
  const std::vector<Variable> variables = {{"omega_1", "rad/s", 11.7, 10.0, 14.0, 0.5},
                                           {"d_1", "1/s", 1.0, 0.1, 3.0, 0.5},
                                           {"omega_2", "rad/s", 19.4, 17.0, 21.0, 0.5},
                                           {"d_2", "1/s", 1.2, 0.1, 3.0, 0.5}};
  const Noting function;
  const SecondsClock clock = [] { return 0.0; };
  const auto result = TinyLeastSquares({}).minimize(function, variables, {}, clock);
  EXPECT_GT(function.calls, 6);
  EXPECT_GT(function.after_third, 0u);
  EXPECT_EQ(function.last, function.after_third);
  EXPECT_NEAR(result.x[0], DampedSinusoids::kTruth[0], 1e-7);
}

TEST(TinyLeastSquares, RefusesADampingThatIsNotPositive) {
  EXPECT_THROW(TinyLeastSquares({.initial_damping = 0.0}), InvalidInput);
}

}  // namespace
}  // namespace modcal::tiny_least_squares_test
