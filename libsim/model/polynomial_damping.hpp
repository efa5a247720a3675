#pragma once

#include "libsim/model/damping.hpp"

namespace modcal {

/// Damping ratio as a polynomial of the mode number, ζ_n = Σ_j c_j n^j; degree 2 is what Debut,
/// Delaune and Antunes (2010, section 7.2) extrapolate measured ratios with.
class PolynomialDamping final : public DampingLaw {
 public:
  struct Options {
    std::vector<double> coefficients = {1e-3};  ///< c_0, c_1, … [1]
    void visit(OptionVisitor& visitor);
  };
  explicit PolynomialDamping(Options options) : options_(std::move(options)) {}

 private:
  double ratio(const DampedMode& mode) const override;
  Options options_;
};

}  // namespace modcal
