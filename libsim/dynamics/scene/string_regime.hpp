// Helmholtz motion, the bow forces that keep it up, and what kind of motion a string has settled
// in.
#pragma once

#include "libsim/dynamics/scene/simulator.hpp"

namespace modcal {

/// Helmholtz motion with the bow velocity v_b [m/s] at the contact x_c [m], in the middle of its
/// stick phase: the corner is at the far end, the string is straight and turns about the near one,
/// q_n = 0, q̇_n = ±2 v_b/(β nπ) (x_c = βL: (−1)^{n+1}; x_c = L − βL: +), β ≤ 1/2 (Helmholtz, 1863;
/// Schelleng, 1973). Modes with a node at the contact are at rest: no bow there keeps them up.
ModalState helmholtz_motion(const ModalBasis& basis, double contact, double bow_velocity);

/// Distance of the contact from the nearer end over the length, β in (0, 1/2].
double relative_bow_position(double contact, double length);

/// Standard deviation over time of the contact's velocity in ideal Helmholtz motion,
/// v_b √((1 − β)/β) [m/s].
double helmholtz_velocity_rms(double relative_position, double bow_velocity);

struct BowForceLimits {
  double lowest = 0.0;   ///< below it the string slips more than once a period [N]
  double highest = 0.0;  ///< above it the corner cannot release the string [N]
};

/// Schelleng's bow-force limits (Schelleng, 1973), with β = x_c/L, the characteristic
/// impedance Z₀ = √(T ρ_L) and Δμ = μ_S − μ(v_b(1 − β)/β), the friction coefficient's fall from its
/// static value to the one at the slip speed of Helmholtz motion:
///   highest = 2 Z₀ v_b/(β Δμ),      lowest = Z₀² v_b/(2 R β² Δμ).
/// His loss, a resistance R at the bridge, gives every mode the damping ratio ζ_n = Z₀/(π n R).
/// Carried out for any damping ratios his argument (the force that feeds each harmonic of Helmholtz
/// motion, half a period after the slip against the one in it) reads
///   lowest = 4 Z₀ v_b/(π β² Δμ) Σ_{n odd ≤ 1/β} ζ_n/n,
/// which is his for his loss since Σ_{n odd} 1/n² = π²/8.
/// Throws InvalidInput for a contact outside the string. Infinite where Δμ = 0.
BowForceLimits schelleng_limits(const Scene& scene);

enum class StringRegime {
  kHelmholtz,     ///< periodic, one slip a period
  kMultipleSlip,  ///< periodic, more slips a period
  kRaucous,       ///< slips without a period near the string's
  kSilent,        ///< held without a slip, or sliding while the motion dies out
};
/// Fixed by: the regimes listed above.
inline constexpr std::size_t kStringRegimes = 4;
/// "helmholtz", "multiple_slip", "raucous", "silent".
std::string_view name_of(StringRegime regime);

/// Where the regimes part. T = 1/f₀ is the string's period, v_b the bow's velocity.
struct RegimeCriteria {
  double periods = 20.0;     ///< at the end of the record, in which the motion is judged
  double slip_share = 0.05;  ///< a stretch of sliding over less than this share of v_b T is none
  double periodicity = 0.9;  ///< least autocorrelation of a periodic motion
  double adherence = 0.25;   ///< least share of the time for which a sounding string sticks
  void visit(OptionVisitor& visitor);
};

/// What the regime is told from.
struct RegimeFeatures {
  double slips_per_period = 0.0;
  /// Largest correlation of the contact's velocity with itself one period later, the period being
  /// sought in [0.8, 1.25] T (of equal ones the nearest to T); 0 for a constant velocity.
  double periodicity = 0.0;
  double period = 0.0;     ///< that period over T
  double adherence = 0.0;  ///< share of the time for which the string sticks
  double amplitude = 0.0;  ///< standard deviation of the velocity over that of Helmholtz motion
};

/// Measures a steady bow stroke at the end of its record. `simulation` has the velocity, and the
/// switches of the judged part at least. A slip is a stretch of sliding in which the string moves
/// against the bow by more than slip_share·v_b T. Throws InvalidInput where the record is too short
/// or the bow does not move.
RegimeFeatures regime_features(const Scene& scene, const Simulation& simulation,
                               const RegimeCriteria& criteria);

/// Silent without a slip or with less adherence than `adherence`; else raucous where the
/// periodicity is less than `periodicity`; else Helmholtz motion with one slip a period (the count
/// may be off by one at the ends of the judged part), multiple slip with more, raucous with fewer:
/// then the period belongs to something else. After Schoonderwaldt, Guettler and Askenfelt (2008),
/// who tell the regimes by the slips of a period, and Galluzzo and Woodhouse (2014), who ask the
/// autocorrelation for the period.
StringRegime classify(const RegimeFeatures& features, const RegimeCriteria& criteria);

/// Time from which regime_features() needs the switches [s].
double judged_from(const Scene& scene, const RegimeCriteria& criteria);

}  // namespace modcal
