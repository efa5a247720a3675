// Modal damping laws: damping ratio ζ_n as a function of the modal frequencies.
#pragma once

#include <limits>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "libsim/base/registry.hpp"

namespace modcal {

/// What a damping law may need to know of its string; NaN where it was not told.
struct StringConstants {
  double length = std::numeric_limits<double>::quiet_NaN();          ///< L [m]
  double linear_density = std::numeric_limits<double>::quiet_NaN();  ///< ρ_L [kg/m]
  double tension = std::numeric_limits<double>::quiet_NaN();         ///< T [N]
  double inharmonicity = std::numeric_limits<double>::quiet_NaN();   ///< B = π² EI/(T L²) [1]
};

/// A mode as a damping law sees it.
struct DampedMode {
  std::size_t index = 0;  ///< n − 1
  double omega = 0.0;     ///< ω_n [rad/s]
  StringConstants string;
};

class DampingLaw {
 public:
  static constexpr std::string_view kKind = "damping";
  static Registry<DampingLaw> registry();

  virtual ~DampingLaw() = default;
  /// Damping ratios ζ_n [1] for the angular frequencies ω_n [rad/s]. Throws InvalidInput where a
  /// ratio leaves [0, 1): the modal propagators need oscillating modes.
  std::vector<double> ratios(std::span<const double> omega,
                             const StringConstants& string = {}) const;

 private:
  virtual double ratio(const DampedMode& mode) const = 0;
};

}  // namespace modcal
