// The fixed-step simulators: what they share, from scene and one-step weights to sampled signals,
// and the two schemes.
#pragma once

#include "libsim/dynamics/fixed_step/step_loop.hpp"
#include "libsim/dynamics/scene/simulator.hpp"

namespace modcal {

using WeightsOfPole = ModeWeights (*)(std::complex<double> pole, double time_step);

/// Exact step of Z' = λ Z + f(t) under a force linear over the step: r = e^x, d₀ = h (φ₁ − φ₂),
/// d₁ = h φ₂ with φ₁ = (eˣ − 1)/x, φ₂ = (eˣ − 1 − x)/x², x = λh (Cox and Matthews, 2002, J. Comput.
/// Phys. 176, second-order exponential differencing).
ModeWeights first_order_hold_weights(std::complex<double> pole, double time_step);

/// r = (1 + λh/2)/(1 − λh/2), d₀ = d₁ = (h/2)/(1 − λh/2).
ModeWeights trapezoidal_weights(std::complex<double> pole, double time_step);

/// Weights of all modes for one step.
SchemeWeights scheme_weights(const ModeTable& modes, double time_step, WeightsOfPole weights);

struct FixedStepScheme {
  ForceTiming timing;
  WeightsOfPole weights;
};

/// Exact propagator of every mode with the force linear over the step (first-order hold) and the
/// friction equation solved at its end: v = v_free + b f has one unknown.
inline constexpr FixedStepScheme kExactScheme{ForceTiming::kImplicit, first_order_hold_weights};

/// Constant average acceleration Newmark in every mode, the modal force taken from the previous
/// step.
inline constexpr FixedStepScheme kNewmarkScheme{ForceTiming::kPreviousStep, trapezoidal_weights};

/// Samples of one contact point.
struct PointMotion {
  explicit PointMotion(std::size_t count) : displacement(count), velocity(count), force(count) {}
  std::vector<double> displacement;  ///< y_j [m]
  std::vector<double> velocity;      ///< v_j [m/s]
  std::vector<double> force;         ///< f_j [N]
};

/// Simulates by steps of `wanted_time_step` [s] or the largest smaller ones that divide 1/f_s. The
/// plain scene (one contact point, steady bow, friction of the sliding speed alone) takes the fast
/// loop, any other the general one. `points`, where asked for, takes the motion of every contact
/// point; the general loop gives it. Throws InvalidInput for steps that are too long for the
/// contact.
Simulation simulate_fixed_step(const Scene& scene, double sample_rate, const OutputRequest& outputs,
                               const StopToken& stop, double wanted_time_step,
                               const FixedStepScheme& scheme,
                               std::vector<PointMotion>* points = nullptr);

struct FixedStepOptions {
  double time_step = 1e-6;  ///< wanted Δt [s]; the largest smaller one that divides 1/f_s is taken
  void visit(OptionVisitor& visitor);
};

/// A simulator of one scheme.
template <const FixedStepScheme& kScheme>
class FixedStepSimulator : public Simulator {
 public:
  using Options = FixedStepOptions;
  explicit FixedStepSimulator(const Options& options) : options_(options) {}

 private:
  Simulation run(const Scene& scene, double sample_rate, const OutputRequest& outputs,
                 const StopToken& stop) const override {
    return simulate_fixed_step(scene, sample_rate, outputs, stop, options_.time_step, kScheme);
  }
  double stated_step() const override { return options_.time_step; }
  Options options_;
};

/// Z_{k+1} = e^{λΔt} Z_k + Δt (φ²/m) [(φ₁ − φ₂) f_k + φ₂ f_{k+1}], x = λΔt.
///
/// No frequency error at any Δt; second order where the force is smooth, first order in the
/// instants of the switches, which it puts on the time grid. Throws InvalidInput where Δt is so
/// long that the friction equation has several solutions.
using ModalExact = FixedStepSimulator<kExactScheme>;

/// The paper's own scheme (Debut, Delaune and Antunes, 2010, section 2.3).
///
/// In the complex modal variable it is the trapezoidal rule Z_{k+1} = r Z_k + d (f_{k−1} + f_k),
/// r = (1 + λΔt/2)/(1 − λΔt/2), d = (Δt/2)/(1 − λΔt/2): the same numbers as the usual (q, q̇, q̈)
/// form, since both are diagonal in the modes. It lowers ω_n by the share (ω_nΔt)²/12 and puts
/// switches on the time grid: at 1 µs its waveforms are not converged, its spectra and regime are.
using NewmarkExplicit = FixedStepSimulator<kNewmarkScheme>;

}  // namespace modcal
