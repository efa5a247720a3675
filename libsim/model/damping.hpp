// Modal damping laws: damping ratio ζ_n as a function of the modal frequencies.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "libsim/base/registry.hpp"

namespace modcal {

class DampingLaw {
 public:
  static constexpr std::string_view kKind = "damping";
  static Registry<DampingLaw> registry();

  virtual ~DampingLaw() = default;
  /// Damping ratios ζ_n [1] for the angular frequencies ω_n [rad/s]. Throws InvalidInput where a
  /// ratio leaves [0, 1): the modal propagators need oscillating modes.
  std::vector<double> ratios(std::span<const double> omega) const;

 private:
  virtual double ratio(std::size_t mode_index, double omega) const = 0;
};

}  // namespace modcal
