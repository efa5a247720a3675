#include "libsim/dynamics/fixed_step/newmark_explicit.hpp"

namespace modcal {

ModeWeights trapezoidal_weights(std::complex<double> pole, double time_step) {
  const std::complex<double> half = 0.5 * time_step * pole;
  const std::complex<double> weight = 0.5 * time_step / (1.0 - half);
  return {.propagate = (1.0 + half) / (1.0 - half), .older = weight, .newer = weight};
}

Simulation NewmarkExplicit::run(const Scene& scene, double sample_rate,
                                const OutputRequest& outputs, const StopToken& stop) const {
  return simulate_fixed_step(scene, sample_rate, outputs, stop, options_.time_step,
                             ForceTiming::kPreviousStep, trapezoidal_weights);
}

}  // namespace modcal
