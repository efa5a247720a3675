#pragma once

#include <limits>

#include "libsim/model/damping.hpp"

namespace modcal {

/// Losses of a metal string, 1/Q_n = 1/Q_air + 1/Q_ve + 1/Q_d, ζ_n = 1/(2 Q_n) (Valette and Cuesta,
/// 1993; in the form of Pâté, Le Carrou and Fabre, 2014):
///   air           1/Q_air = R/(2π ρ_L f_n),  R = 2πη + 2πd √(π η ρ f_n)
///   viscoelastic  1/Q_ve = 4π² ρ_L EI δ f_n²/T²,  EI = B T L²/π²
///   dislocations and thermoelasticity  1/Q_d, the same for all modes
/// with the diameter d [m], viscosity η [Pa s] and density ρ [kg/m³] of the air, loss angle δ [1].
class ValetteCuestaDamping final : public DampingLaw {
 public:
  struct Options {
    double diameter = std::numeric_limits<double>::quiet_NaN();    ///< d [m]
    double loss_angle = std::numeric_limits<double>::quiet_NaN();  ///< δ [1]
    double constant = std::numeric_limits<double>::quiet_NaN();    ///< 1/Q_d [1]
    double air_viscosity = 1.8e-5;                                 ///< η [Pa s]
    double air_density = 1.2;                                      ///< ρ [kg/m³]
    void visit(OptionVisitor& visitor);
  };
  explicit ValetteCuestaDamping(const Options& options) : options_(options) {}

 private:
  double ratio(const DampedMode& mode) const override;
  Options options_;
};

}  // namespace modcal
