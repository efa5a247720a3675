#pragma once

#include "libcalib/objective.hpp"

namespace modcal {

/// Spectral-peak integral, C = Σ_n Σ_r ∫ |F_r(ω)| dω over ω*_n (1 ± half_band) with F_r = R_r/H_r,
/// in N (Debut, Delaune and Antunes, 2010, eq. 17, over both reactions where both are there): a
/// wrong modal frequency shows as a spurious peak of the identified force.
///
/// The value sums over the modes whose frequency is free (all modes where only x_c is), with bands
/// about the initial frequencies. The scan of one f_n is the paper's: the integral of that mode
/// alone, its band centered at the current f*_n. Has a gradient wherever no |F_r| vanishes. |F| is
/// estimated by |DFT|/f_s and the integral by the sum over bins.
class SpectralPeak final : public Objective {
 public:
  struct Options {
    double half_band = 0.04;  ///< relative to f*_n [1]
    void visit(OptionVisitor& visitor);
  };
  explicit SpectralPeak(const Options& options);

  /// A sum of magnitudes: no residuals. smooth_spectral_peak has them.
  Capabilities capabilities() const override { return {.gradient = true}; }

 private:
  /// Throws InvalidInput where a band holds no bin.
  std::unique_ptr<const ObjectiveFunction> do_bind(const CalibrationData& data,
                                                   const ParameterSet& parameters) const override;

  Options options_;
};

}  // namespace modcal
