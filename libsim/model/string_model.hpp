// The string as a user describes it.
#pragma once

#include "libsim/base/registry.hpp"
#include "libsim/model/damping.hpp"

namespace modcal {

/// Pinned string of length L [m], linear density ρ_L [kg/m] and ideal fundamental f₀ [Hz], tension
/// T = 4 L² f₀² ρ_L [N], modal frequencies ω_n = 2π n f₀ √(1 + B n²) (Debut, Delaune and Antunes,
/// 2010, eqs. 9 and 18; with f₀ the fundamental of the string without stiffness: the measured first
/// frequency is f₁ = f₀ √(1 + B)).
struct StringModel {
  double length = std::numeric_limits<double>::quiet_NaN();
  double linear_density = std::numeric_limits<double>::quiet_NaN();
  double fundamental = std::numeric_limits<double>::quiet_NaN();
  double inharmonicity = 0.0;
  std::int64_t modes = 50;  ///< N; 0: as many as the record tells
  Choice<DampingLaw> damping{"constant"};

  double tension() const {
    return 4.0 * length * length * fundamental * fundamental * linear_density;
  }
  /// Transverse wave speed c = 2 L f₀ [m/s].
  double wave_speed() const { return 2.0 * length * fundamental; }
  bool modes_of_record() const { return modes == 0; }
  /// With 50 modes where the record is to tell how many: what is checked before it is read.
  StringModel before_reading() const;
  void visit(OptionVisitor& visitor);
};

/// f_n = n f₀ √(1 + B n²) [Hz], n ≥ 1 (eq. 18 with the ideal fundamental f₀).
double stiff_string_frequency(double fundamental, double inharmonicity, std::size_t n);

/// How many modes of the stiff-string law lie below `highest` [Hz].
std::int64_t modes_below(const StringModel& string, double highest);

}  // namespace modcal
