#pragma once

#include <limits>

#include "libsim/model/damping.hpp"

namespace modcal {

/// Three-term losses of a string,
///   1/Q_n = [T (η_F + η_A/ω_n) + EI η_B (nπ/L)²]/[T + EI (nπ/L)²],   ζ_n = 1/(2 Q_n)
/// (Woodhouse, 2004, "On the synthesis of guitar plucks"): internal friction η_F [1], air
/// η_A [1/s], bending η_B [1]. With B = π² EI/(T L²) the ratio of the two stiffnesses is B n².
class WoodhouseDamping final : public DampingLaw {
 public:
  struct Options {
    double friction = std::numeric_limits<double>::quiet_NaN();  ///< η_F [1]
    double air = std::numeric_limits<double>::quiet_NaN();       ///< η_A [1/s]
    double bending = std::numeric_limits<double>::quiet_NaN();   ///< η_B [1]
    void visit(OptionVisitor& visitor);
  };
  explicit WoodhouseDamping(const Options& options) : options_(options) {}

 private:
  double ratio(const DampedMode& mode) const override;
  Options options_;
};

}  // namespace modcal
