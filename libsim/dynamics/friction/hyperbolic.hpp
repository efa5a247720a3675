#pragma once

#include "libsim/dynamics/friction/friction_law.hpp"

namespace modcal {

/// Coulomb friction whose coefficient falls as a hyperbola of the sliding speed,
/// f_c = −sgn(v_c) F_N [μ_D + (μ_S − μ_D)/(1 + |v_c|/v₀)], 0 ≤ μ_D ≤ μ_S, v₀ > 0 [m/s]: at v₀ half
/// of the fall has happened (the friction curve of McIntyre, Schumacher and Woodhouse, 1983, as
/// Serafin, Smith and Woodhouse, 1999, write it).
class Hyperbolic final : public FrictionLaw {
 public:
  struct Options {
    double static_coefficient = 0.4;   ///< μ_S [1]
    double dynamic_coefficient = 0.2;  ///< μ_D [1]
    double half_speed = 0.1;           ///< v₀ [m/s]
    Adherence adherence;
    void visit(OptionVisitor& visitor);
  };
  explicit Hyperbolic(const Options& options);
  Adherence adherence() const override { return options_.adherence; }

 private:
  SlidingLaw make_sliding(double normal_force) const override;
  double static_coefficient() const override { return options_.static_coefficient; }
  Options options_;
};

}  // namespace modcal
