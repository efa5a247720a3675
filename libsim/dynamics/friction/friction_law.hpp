// Friction between bow and string.
#pragma once

#include <limits>
#include <string_view>

#include "libsim/base/registry.hpp"
#include "libsim/dynamics/friction/sliding_laws.hpp"
#include "libsim/dynamics/friction/stateful_laws.hpp"

namespace modcal {

/// Spring and damper that hold the string to the bow while it sticks (Debut, Delaune and Antunes,
/// 2010, eq. 8): f_c = −K_a y_c − C_a v_c, y_c = y − y_attach − v_bow (t − t_attach).
struct Adherence {
  double stiffness = 1e5;  ///< K_a [N/m]
  /// C_a [N s/m]; NaN: near critical, C_a = 2 √(K_a m_eff), 1/m_eff = Σ φ_n(x_c)²/m_n.
  double damping = std::numeric_limits<double>::quiet_NaN();
  void visit(OptionVisitor& visitor);
};

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
  StatefulLaw stateful() const { return make_stateful(); }
  bool has_state() const { return stateful().index() != 0; }
  /// Largest force that adherence can carry, μ_S F_N [N].
  double static_limit(double normal_force) const;
  virtual Adherence adherence() const = 0;

 private:
  virtual SlidingLaw make_sliding(double normal_force) const;
  virtual StatefulLaw make_stateful() const { return {}; }
  virtual double static_coefficient() const = 0;
};

}  // namespace modcal
