// What the fixed-step simulators share: from scene and one-step weights to sampled signals.
#pragma once

#include <complex>
#include <span>

#include "libsim/dynamics/scene/simulator.hpp"
#include "libsim/dynamics/fixed_step/step_loop.hpp"

namespace modcal {

struct FixedStepOptions {
  double time_step = 1e-6;  ///< wanted Δt [s]; the largest smaller one that divides 1/f_s is taken
  void visit(OptionVisitor& visitor);
};

/// One-step weights r, d₀, d₁ of a mode with pole λ [1/s] for the step h [s].
struct ModeWeights {
  std::complex<double> propagate, older, newer;
};
using WeightsOfPole = ModeWeights (*)(std::complex<double> pole, double time_step);

/// Weights of all modes for one step.
SchemeWeights scheme_weights(std::span<const std::complex<double>> poles, double time_step,
                             WeightsOfPole weights);

/// The plain scene (one contact point, steady bow, friction of the sliding speed alone) takes the
/// fast loop, any other the general one.
Simulation simulate_fixed_step(const Scene& scene, double sample_rate, const OutputRequest& outputs,
                               const StopToken& stop, double wanted_time_step, ForceTiming timing,
                               WeightsOfPole weights_of_pole);

}  // namespace modcal
