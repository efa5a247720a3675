// An optimizer of one's own finds where a simulated string was bowed.
#include "libcalib/objective.hpp"
#include "libcalib/optimizer.hpp"
#include "libsim/simulate.hpp"

using namespace modcal;

// Steps along the first variable; turns and halves the step where the value rises.
class Compass final : public Optimizer {
  std::string_view name() const override { return "compass"; }
  StopReason search(Evaluator& evaluator) const override {
    double z = 0.0, best = evaluator.value({&z, 1});
    for (double step = 1.0; step * step > 1e-8;) {
      const double next = z + step, value = evaluator.value({&next, 1});
      value < best ? z = next : step *= -0.5;
      best = std::min(best, value);
    }
    return StopReason::kSmallStep;
  }
};

int main() {
  const StringModel string{.length = 0.33, .linear_density = 3.1e-3, .fundamental = 196.0};
  const auto run = simulate({.string = string, .bow = {.position = 0.03}});
  const auto data =
      CalibrationData::of_records(run.left_reaction.samples, run.right_reaction.samples, 51200.0);
  const ParameterSet free({make_modal_basis(string), 0.032}, std::vector<std::string>{"x_c"});
  const auto objective = Choice<Objective>("contact_location").make()->bind(data, free);
  std::printf("x_c = %.5f m\n", Compass().minimize(*objective, free.variables(), {}).x[0]);
}
