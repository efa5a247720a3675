#pragma once

#include "libcalib/objective.hpp"
#include "libcalib/objectives/two_sided_force.hpp"

namespace modcal {

/// Smooth variant of contact_location, half its square, as residuals: r_k = √2 (F_1 −
/// F_2)(ω_k)/√(‖F_1‖² + ‖F_2‖²), real and imaginary part of every bin in turn, value ½ ‖r‖² [1].
/// Its minimum is that of contact_location, where that has a kink (for data the model explains
/// exactly) and this has none.
class ContactLocationSquares final : public Objective {
 public:
  struct Options {
    TwoSidedForceOptions inversion;
    void visit(OptionVisitor& visitor) { inversion.visit(visitor); }
  };
  explicit ContactLocationSquares(const Options& options) : options_(options) {}

 private:
  /// Throws InvalidInput where a reaction is missing or x_c is not free.
  std::unique_ptr<const ObjectiveFunction> do_bind(const CalibrationData& data,
                                                   const ParameterSet& parameters) const override;

  Options options_;
};

}  // namespace modcal
