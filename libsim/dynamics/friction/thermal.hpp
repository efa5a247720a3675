#pragma once

#include "libsim/dynamics/friction/friction_law.hpp"

namespace modcal {

/// Rosin friction: the coefficient follows the temperature of the contact, not the sliding speed,
///   f_c = −sgn(v_c) F_N μ(ϑ),  μ(ϑ) = μ_hot + (μ_cold − μ_hot)/(1 + e^((ϑ − ϑ_s)/w)),
///   H ϑ' = |f_c v_c| − (G + S |v_c|) ϑ
/// (Smith and Woodhouse, 2000, "The tribology of rosin"; Woodhouse, 2003, "Bowed string simulation
/// using a thermal friction model"). ϑ [K] is the rise above the surroundings, H [J/K]
/// the heat capacity of the contact, G [W/K] the conduction into string and bow, S |v_c| [W/K] the
/// heat that leaves with the material rubbed past; the cited work convolves a thermal Green's
/// function in the place of G, and fits a yield stress to measurements in that of the sigmoid,
/// which stands for the softening of rosin at ϑ_s within about ±2w. Adherence carries μ(ϑ) F_N and
/// heats nothing.
class Thermal final : public FrictionLaw {
 public:
  struct Options {
    double cold_coefficient = 0.8;  ///< μ_cold [1]
    double hot_coefficient = 0.2;   ///< μ_hot [1], at most μ_cold
    double softening_rise = 20.0;   ///< ϑ_s [K]
    double softening_width = 6.0;   ///< w [K]
    double heat_capacity = 5e-6;    ///< H [J/K]
    double conductance = 2e-3;      ///< G [W/K]
    double carried_heat = 1e-3;     ///< S [J/(K m)]
    Adherence adherence;
    void visit(OptionVisitor& visitor);
  };
  explicit Thermal(const Options& options);
  Adherence adherence() const override { return options_.adherence; }

 private:
  StatefulLaw make_stateful() const override;
  double static_coefficient() const override;
  Options options_;
};

}  // namespace modcal
