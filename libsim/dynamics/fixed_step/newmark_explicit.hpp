#pragma once

#include "libsim/dynamics/fixed_step/fixed_step.hpp"

namespace modcal {

/// r = (1 + λΔt/2)/(1 − λΔt/2), d₀ = d₁ = (Δt/2)/(1 − λΔt/2) of a mode with pole λ [1/s].
ModeWeights trapezoidal_weights(std::complex<double> pole, double time_step);

/// The paper's own scheme: constant average acceleration Newmark in every mode, the modal force
/// taken from the previous step (Debut, Delaune and Antunes, 2010, section 2.3).
///
/// In the complex modal variable it is the trapezoidal rule Z_{k+1} = r Z_k + d (f_{k−1} + f_k),
/// r = (1 + λΔt/2)/(1 − λΔt/2), d = (Δt/2)/(1 − λΔt/2): the same numbers as the usual (q, q̇, q̈)
/// form, since both are diagonal in the modes. It lowers ω_n by the share (ω_nΔt)²/12 and puts
/// switches on the time grid: at 1 µs its waveforms are not converged, its spectra and regime are.
class NewmarkExplicit final : public Simulator {
 public:
  using Options = FixedStepOptions;
  explicit NewmarkExplicit(const Options& options) : options_(options) {}

 private:
  Simulation run(const Scene& scene, double sample_rate, const OutputRequest& outputs,
                 const StopToken& stop) const override;
  Options options_;
};

}  // namespace modcal
