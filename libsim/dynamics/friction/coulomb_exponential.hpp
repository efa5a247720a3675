#pragma once

#include "libsim/dynamics/friction/friction_law.hpp"

namespace modcal {

/// Coulomb friction whose coefficient falls exponentially with the sliding speed,
/// f_c = −sgn(v_c) F_N [μ_D + (μ_S − μ_D) exp(−C|v_c|)], 0 ≤ μ_D ≤ μ_S (Debut, Delaune and Antunes,
/// 2010, eqs. 5 and 7).
class CoulombExponential final : public FrictionLaw {
 public:
  struct Options {
    double static_coefficient = 0.4;   ///< μ_S [1]
    double dynamic_coefficient = 0.2;  ///< μ_D [1]
    double decay = 5.0;                ///< C [s/m]
    Adherence adherence;
    void visit(OptionVisitor& visitor);
  };
  explicit CoulombExponential(const Options& options);
  Adherence adherence() const override { return options_.adherence; }

 private:
  SlidingLaw make_sliding(double normal_force) const override;
  double static_coefficient() const override { return options_.static_coefficient; }
  Options options_;
};

}  // namespace modcal
