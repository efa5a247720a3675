// What a fit makes of a record, and what causes of misfit would add to it.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "libcalib/identifiability/misfit_causes.hpp"
#include "libsim/signal/fft.hpp"

namespace modcal {

/// What the fit makes of a record: force, transfer functions, what rings; and what causes of misfit
/// would add to it (misfit_causes()).
class FittedRecord {
 public:
  FittedRecord(const ProjectedLikelihood& likelihood, const ModelPoint& point);

  // A share of the reactions once more, of a string whose frequencies are δ higher: of every mode
  // q + d, D(δ) d = −(D(δ) − D) q, and what is quasi-static stays. What force and decays of the fit
  // are apart is told badly, their sum q, the motion, well. The spectra are those of a motion that
  // goes on where it began: what d has at t = 0 decays from there.
  MisfitCause polarization(double detuning) const;

  // Mode by mode D_n q_n = f − 2ω_n² p (t/T − 1/2) q_n: the motion as it is fitted, in the time
  // domain, drives its own change.
  MisfitCause drift() const;

  // The end at x = L is on a mode of the body, m (s² + 2ζω_b s + ω_b²) u = −R₂. To first order in
  // 1/m the reactions of a pinned string have those of the chord u x/L more,
  //     c₂ = T/L + (2T/L) Σ s²/D_n,   c₁ = −T/L − (2T/L) Σ (−1)^n s²/D_n;
  // by 1/m and by both parts of what the mode of the body itself still has from before. The poles
  // become s_n (1 − (T/mL)/(s_n² + 2ζω_b s_n + ω_b²)).
  MisfitCause bridge(double frequency, double zeta) const;

  // A sensor that has a mode of its own: of what it senses two shares more.
  MisfitCause resonance(bool right, double frequency, double zeta) const;

  MisfitCause nonlinear_sensors() const;

  MisfitCause modes_above() const;

  // The force acts at x_c + Σ_j p_j φ_j(t) with |φ_j| ≤ 1: by p_j [m] the reactions have ∂H_r/∂x_c
  // of the force φ_j(t) f(t) more. What rings from before does not depend on where the force acts.
  MisfitCause moving_contact() const;

 private:
  std::size_t samples() const;
  PlanarVector numbers() const { return PlanarVector(record_.root_weight.size()); }

  static Complex inverse_denominator(const LikelihoodMode& mode, Complex s);
  // Takes from a motion the decay from its state at t = 0, whose sum over the bins is given, and
  // that of its rate: c with 2 Re c and 2 Re c r the state, r the rate of the pole.
  void decay(const LikelihoodMode& mode, double detuning, Complex sum, Complex rate_sum,
             std::vector<Complex>& motion) const;
  // Multiplies what is known by its numbers in the bins by a function of t/T in the time domain.
  std::vector<Complex> modulated(std::span<const Complex> numbers,
                                 const std::function<double(double)>& factor) const;
  // Sums of modal contributions: what the ends read of odd modes differs in its sign.
  struct Motions {
    explicit Motions(std::size_t bins) : odd(bins), even(bins) {}
    void add(const std::vector<Complex>& motion, bool is_even);
    std::vector<Complex> odd, even;
  };
  // What they are in bin k of the whitened records.
  NoisePair ends(const Motions& motions, std::size_t k) const;
  // Mode n with what rings of it, in bin k.
  Complex motion_of(std::size_t n, std::size_t k, Complex receptance) const;
  // The records less their noise, e's share of them.
  NoisePair fitted(std::size_t k) const;
  // The record of one end less its noise, cubed over its mean square.
  PlanarVector cubed(bool right) const;

  const WhitenedRecord& record_;
  const Sensor& sensor_;
  std::vector<LikelihoodMode> modes_;
  std::size_t own_;    // modes that the model states, the first
  double per_length_;  // T/L [N/m]
  RealFft fft_;
  std::vector<Complex> force_, amplitudes_, left_, right_, residual_;
  std::vector<Complex> read_;      // S of the sensor at x = L in every bin
  std::vector<Complex> reaction_;  // R_2, as recorded where a bridge was taken out of it [N]
  // What the ends read of a displacement of x = L, whitened [1/m].
  std::vector<Complex> chord_left_, chord_right_;
  std::vector<std::vector<Complex>> motions_;  // of every stated mode, what rings of it included
};

}  // namespace modcal
