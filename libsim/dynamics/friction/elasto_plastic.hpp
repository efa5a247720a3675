#pragma once

#include <string>

#include "libsim/dynamics/friction/friction_law.hpp"

namespace modcal {

/// Bristle friction: the contact deflects elastically by z [m] before it slides,
///   f_c = −(σ₀ z + σ₁ z'),  z' = v_c (1 − α(z, v_c) σ₀ z sgn(v_c)/g(v_c)),
///   g(v) = F_N [μ_D + (μ_S − μ_D) exp(−(v/v_s)²)]
/// (Dupont, Hayward, Armstrong and Altpeter, 2002; α = 1: LuGre, Canudas de Wit, Olsson, Åström and
/// Lischinsky, 1995). In steady sliding f_c = −sgn(v_c) g(v_c). The bristles take the place of the
/// adherence spring: σ₀ = K_a, σ₁ = C_a, the latter limited to 4 g(v)/|v|: then the power that is
/// neither stored nor given back, σ₀ a z² + σ₁ v² − σ₁ a v z with a = α σ₀|v|/g, is never negative
/// (on the passivity of the LuGre model: Barahanov and Ortega, 2000).
class ElastoPlastic final : public FrictionLaw {
 public:
  struct Options {
    double static_coefficient = 0.4;   ///< μ_S [1]
    double dynamic_coefficient = 0.2;  ///< μ_D [1]
    double stribeck_speed = 0.1;       ///< v_s [m/s]
    std::string model = "elasto_plastic";
    double breakaway = 0.7;  ///< deflection up to which z is elastic, over μ_D F_N/σ₀ [1]
    Adherence bristle;
    void visit(OptionVisitor& visitor);
  };
  explicit ElastoPlastic(const Options& options);
  Adherence adherence() const override { return options_.bristle; }

 private:
  StatefulLaw make_stateful() const override;
  double static_coefficient() const override { return options_.static_coefficient; }
  Options options_;
};

}  // namespace modcal
