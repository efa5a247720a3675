// What kind of motion a bowed string has settled in.
#pragma once

#include <string_view>

#include "libsim/base/options.hpp"
#include "libsim/dynamics/scene/simulator.hpp"

namespace modcal {

enum class StringRegime {
  kHelmholtz,     ///< periodic, one slip a period
  kMultipleSlip,  ///< periodic, more slips a period
  kRaucous,       ///< slips without a period near the string's
  kSilent,        ///< held without a slip, or sliding while the motion dies out
};
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
