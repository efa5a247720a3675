// An objective of one's own, which any optimizer minimizes: fundamental and inharmonicity of a
// string from the frequencies that a tuner shows.
#include <array>
#include <cmath>
#include <cstdio>

#include "libcalib/optimizer.hpp"

using namespace modcal;

class TunerMisfit final : public ObjectiveFunction {
  std::string_view name() const override { return "tuner_misfit"; }
  std::size_t dimension() const override { return 2; }
  Capabilities capabilities() const override { return {}; }
  // Sum of squares of n f0 sqrt(1 + B n^2)/f_n - 1 at x = (f0, B).
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& out) const override {
    const std::array shown = {196.0273, 392.2181, 588.7358, 785.7436, 983.4044};  // [Hz]
    *out.value = 0.0;
    for (int n = 1; n <= 5; ++n)
      *out.value += std::pow(n * x[0] * std::sqrt(1.0 + x[1] * n * n) / shown[n - 1] - 1.0, 2);
  }
};

int main() {
  const std::array variables = {Variable{"f0", "Hz", 198.0, 190.0, 200.0, 1.0},
                                Variable{"B", "", 0.0, -1e-3, 1e-3, 1e-4}};
  const auto nlopt = Choice<Optimizer>("nlopt").make();
  const OptimizationResult found = nlopt->minimize(TunerMisfit(), variables, {});
  std::printf("f0 = %.4f Hz, B = %.3g\n", found.x[0], found.x[1]);
}
