// What happens: string, bow, initial motion and duration. How it is computed is the simulator's
// business.
#pragma once

#include "libsim/dynamics/friction/friction_law.hpp"
#include "libsim/dynamics/gestures/bow.hpp"
#include "libsim/model/modal_basis.hpp"

namespace modcal {

/// Modal displacements q_n [m] and velocities q̇_n [m/s] at t = 0; empty: at rest.
struct ModalState {
  std::vector<double> displacement;
  std::vector<double> velocity;
};

class InitialMotion {
 public:
  static constexpr std::string_view kKind = "initial";
  static Registry<InitialMotion> registry();

  virtual ~InitialMotion() = default;
  /// Modal state of the string at t = 0: empty or as many values as modes.
  virtual ModalState state(const ModalBasis& basis) const = 0;
  /// Whether the string does not move by itself.
  virtual bool at_rest() const { return false; }
};

/// The string lies straight and at rest.
class Rest final : public InitialMotion {
 public:
  struct Options {
    void visit(OptionVisitor& /*visitor*/) {}
  };
  explicit Rest(const Options& /*options*/) {}
  ModalState state(const ModalBasis& /*basis*/) const override { return {}; }
  bool at_rest() const override { return true; }
};

/// The string is released at t = 0 from the triangle with its corner at x_p, of height h, rounded
/// as by a plectrum of width w that presses evenly on the flexible string:
/// q_n = 2 h L²/(n²π² x_p (L − x_p)) sin(nπx_p/L) sinc(n w/(2L)), sinc(u) = sin(πu)/(πu)
/// (Fletcher and Rossing, 1998, section 2.8, for w = 0); 0 < x_p < L, w/2 within the nearer end.
class Pluck final : public InitialMotion {
 public:
  struct Options {
    double position = std::numeric_limits<double>::quiet_NaN();      ///< x_p [m]
    double displacement = std::numeric_limits<double>::quiet_NaN();  ///< h [m]
    double width = 0.0;                                              ///< w [m]
    void visit(OptionVisitor& visitor);
  };
  explicit Pluck(const Options& options) : options_(options) {}
  ModalState state(const ModalBasis& basis) const override;

 private:
  Options options_;
};

/// Torsional modes, coupled to the transverse ones by the contact force alone (Friedlander, 1953;
/// Serafin, Smith and Woodhouse, 1999): the friction force f turns the string by the torque a f,
/// and the friction law sees the velocity of the surface v + a θ'. In the surface displacement
/// a θ = Σ sin(nπx/L) τ_n,
///   m_T (τ_n'' + 2 ζ_T ω_n τ_n' + ω_n² τ_n) = sin(nπx_c/L) f_c,  ω_n = n π c_T/L,  m_T = μ_T L/2,
/// where μ_T = I/a² = Z_T/c_T [kg/m] is the moment of inertia per length seen at the surface: the
/// radius a drops out. Torsion exerts no force on the ends of the string.
struct Torsion {
  bool present = false;
  std::int64_t modes = 20;
  double speed_ratio = 5.0;      ///< c_T/c, torsional over transverse wave speed [1]
  double impedance_ratio = 2.0;  ///< Z_T/Z₀, Z₀ = ρ_L c [1]
  double damping_ratio = 1e-2;   ///< ζ_T [1]
  void visit(OptionVisitor& visitor);

  /// The torsional modes of a string in surface displacement; no tension: no reactions. Empty where
  /// not present.
  ModalBasis basis(const ModalBasis& transverse, double wave_speed) const;
};

struct ContactModes;

struct Scene {
  StringModel string;
  Bow bow;
  Choice<FrictionLaw> friction{"coulomb_exponential"};
  double duration = 1.0;  ///< [s]
  Choice<InitialMotion> start{"rest"};
  Torsion torsion;
  /// Modal state set in code, in the place of `start`; empty: that of `start`.
  ModalState initial;
  /// Modes set in code, in the place of the string, of bow.position and of what `start` says; null:
  /// the string's (libsim/dynamics/scene/driven_structure.hpp).
  std::shared_ptr<const ContactModes> structure;
  void visit(OptionVisitor& visitor);
};

/// The modal state of the scene's string at t = 0.
ModalState initial_state(const Scene& scene, const ModalBasis& basis);

}  // namespace modcal
