#pragma once

#include "libsim/dynamics/fixed_step/fixed_step.hpp"

namespace modcal {

/// Exact propagator of every mode with the force linear over the step (first-order hold) and the
/// friction equation solved at its end: Z_{k+1} = e^{λΔt} Z_k + Δt (φ²/m) [(φ₁ − φ₂) f_k + φ₂
/// f_{k+1}], φ₁(x) = (eˣ − 1)/x, φ₂(x) = (eˣ − 1 − x)/x², x = λΔt, and v = v_free + b f: one
/// unknown.
///
/// No frequency error at any Δt; second order where the force is smooth, first order in the
/// instants of the switches, which it puts on the time grid. Throws InvalidInput where Δt is so
/// long that the friction equation has several solutions.
class ModalExact final : public Simulator {
 public:
  using Options = FixedStepOptions;
  explicit ModalExact(const Options& options) : options_(options) {}

 private:
  Simulation run(const Scene& scene, double sample_rate, const OutputRequest& outputs,
                 const StopToken& stop) const override;
  Options options_;
};

}  // namespace modcal
