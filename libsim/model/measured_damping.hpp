#pragma once

#include <cstdint>

#include "libsim/model/damping.hpp"
#include "libsim/model/damping_fit.hpp"

namespace modcal {

/// Damping ratios measured on some modes and extrapolated to all by a polynomial of the mode
/// number, fitted by least squares (Debut, Delaune and Antunes, 2010, section 7.2: degree 2, 11
/// modes).
class MeasuredDamping final : public DampingLaw {
 public:
  struct Options {
    std::vector<std::int64_t> modes;  ///< mode numbers n ≥ 1
    std::vector<double> ratios;       ///< ζ_n [1], as many
    std::int64_t degree = 2;
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput where modes and ratios do not pair up or are too few for the degree.
  explicit MeasuredDamping(const Options& options);

 private:
  double ratio(const DampedMode& mode) const override;
  DampingFit fit_;
};

}  // namespace modcal
