// The string as a structure: its modal model from the contact force to the reactions at its ends.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "libsim/model/modal_basis.hpp"
#include "libsim/model/modal_model.hpp"
#include "libsim/model/sensor.hpp"

namespace modcal {

/// The end of the string whose reaction is meant.
enum class End { kLeft = 0, kRight = 1 };  // x = 0, x = L

/// Reaction per modal amplitude: g₁ₙ = −T nπ/L at x = 0, g₂ₙ = (−1)ⁿ T nπ/L at x = L [N/m]
/// (Debut, Delaune and Antunes, 2010, eq. 9).
std::vector<double> reaction_gains(const ModalBasis& basis, End end);

/// Two sensors of force at the ends, H_r(s) = Σ_n g_rn φ_n/(m_n D_n(s)) [N/N] (Debut, Delaune and
/// Antunes, 2010, eq. 11), for modes that the contact reaches by φ_n = `shape`.
ModalModel end_reactions(const ModalBasis& basis, std::span<const double> shape);
/// The same for a contact at x_c in [0, L] [m]. Throws InvalidInput outside.
ModalModel end_reactions(const ModalBasis& basis, double contact);
/// ∂H_r/∂x_c of it: φ_n replaced by dφ_n/dx = (nπ/L) cos(nπx_c/L).
ModalModel end_reaction_slopes(const ModalBasis& basis, double contact);

/// What a transfer function of a string holds besides the stated modes.
struct StringSupport {
  bool remainder = false;  ///< the modes above the highest stated one answer too
  /// The support feels T y_x − E I y_xxx instead of T y_x: g_rn times (1 + B n²).
  bool bending = false;
  bool bending_open = false;  ///< nobody says whether it does
};

/// The same as an experiment states it.
struct SupportOptions {
  /// "law": modes above the highest stated one answer as the law has them; "none": they do not
  /// exist, as in a simulated string of that many modes; "auto": law for recorded data.
  std::string remainder = "auto";
  /// What the sensors feel: "tension", "support", or "auto": the tension, of recorded data not
  /// known.
  std::string reaction = "auto";
  void visit(OptionVisitor& visitor);
  /// `recorded`: the data are no simulation.
  StringSupport support(bool recorded) const;
  /// Whether they feel the bending, as far as it is stated.
  std::optional<bool> bending() const;
};

/// end_reactions() and, third, a sensor of displacement at the contact: the receptance
/// Y/F = Σ_n φ_n²/(m_n D_n(s)) [m/N], the paper's eq. 13. The mobility is s times it.
ModalModel string_model(const ModalBasis& basis, double contact, const StringSupport& support = {});

/// H_r of end_reactions() at all bins [N/N].
std::vector<Complex> reaction_transfer(const ModalBasis& basis, double contact, End end,
                                       const FrequencyGrid& grid);
/// The receptance of string_model() at all bins [m/N].
std::vector<Complex> contact_receptance(const ModalBasis& basis, double contact,
                                        const FrequencyGrid& grid);

/// B of ω_n = n ω₀ √(1 + B n²), ω₀ from tension and mass: least squares of (ω_n/(n ω₀))² − 1 over
/// B n², 0 where that is negative.
double inharmonicity_of(const ModalBasis& basis);

/// Static response of all modes, 1 … ∞, to a force at ξ = x_c/L.
struct StaticResponse {
  std::array<double, 2> reaction = {0.0, 0.0};  ///< [N/N]
  double compliance = 0.0;                      ///< [m/N]
};

/// Closed form: −(1 − ξ), −ξ and L ξ(1 − ξ)/T for B = 0 (or, reactions, with the bending part),
/// else with sinh and cosh of π/√B (Gradshteyn and Ryzhik, 2007, 1.445).
StaticResponse static_response(const ModalBasis& basis, double contact, bool bending);
/// The part of it that the modes of the basis hold, B as in the law.
StaticResponse static_response_of_modes(const ModalBasis& basis, double contact, bool bending);

}  // namespace modcal
