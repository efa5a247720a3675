// Friction between bow and string.
#pragma once

#include "libsim/base/registry.hpp"
#include "libsim/dynamics/friction/sliding_laws.hpp"

namespace modcal {

/// Spring and damper that hold the string to the bow while it sticks (Debut, Delaune and Antunes,
/// 2010, eq. 8): f_c = −K_a y_c − C_a v_c, y_c = y − y_attach − v_bow (t − t_attach).
struct Adherence {
  double stiffness = 1e5;  ///< K_a [N/m]
  /// C_a [N s/m]; NaN: near critical, C_a = 2 √(K_a m_eff), 1/m_eff = Σ φ_n(x_c)²/m_n.
  double damping = std::numeric_limits<double>::quiet_NaN();
  void visit(OptionVisitor& visitor);
};

/// A friction law as the simulators take it: a curve over the sliding speed or a law with a state.
class FrictionLaw {
 public:
  static constexpr std::string_view kKind = "friction";
  static Registry<FrictionLaw> registry();

  virtual ~FrictionLaw() = default;
  /// The sliding law for the normal force F_N ≥ 0 [N], proportional to F_N; for F_N = 1 N it is the
  /// friction coefficient.
  /// Throws InvalidInput for a law with a state.
  SlidingLaw sliding(double normal_force) const;
  /// The law where it has a state (temperature, deflection); std::monostate where it has none.
  const StatefulLaw& stateful() const { return stateful_; }
  bool has_state() const { return stateful_.index() != 0; }
  /// Largest force that adherence can carry, μ_S F_N [N].
  double static_limit(double normal_force) const;
  const Adherence& adherence() const { return adherence_; }

 protected:
  /// `coefficient`: the law for F_N = 1 N; `stateful`: in its place, where there is one.
  FrictionLaw(const Adherence& adherence, double static_coefficient, const SlidingLaw& coefficient,
              const StatefulLaw& stateful = {})
      : adherence_(adherence),
        static_coefficient_(static_coefficient),
        coefficient_(coefficient),
        stateful_(stateful) {}

 private:
  Adherence adherence_;
  double static_coefficient_;
  SlidingLaw coefficient_;
  StatefulLaw stateful_;
};

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
};

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
};

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
};

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
};

}  // namespace modcal
