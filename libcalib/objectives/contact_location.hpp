#pragma once

#include "libcalib/objective.hpp"
#include "libcalib/objectives/two_sided_force.hpp"

namespace modcal {

/// Relative difference of the two identified force waveforms,
/// ‖f_1 − f_2‖/√(½ (‖f_1‖² + ‖f_2‖²)) [1], as a function of x_c (Debut, Delaune and Antunes, 2010,
/// section 7.2: the contact location "has been adjusted to minimize the difference between the two
/// identified force waveforms"). By Parseval's theorem the norms of the waveforms are sums over
/// bins, so that no waveform is computed. The waveforms are those of the band; with common_filter
/// off they are what two one-sided inversions give. Other parameters may be free beside x_c. The
/// gradient is set to 0 where the waveforms are equal, which is the smallest value there is.
class ContactLocation final : public Objective {
 public:
  struct Options {
    TwoSidedForceOptions inversion;
    void visit(OptionVisitor& visitor) { inversion.visit(visitor); }
  };
  explicit ContactLocation(const Options& options) : options_(options) {}

  /// A norm, not its square: no residuals. contact_location_squares has them.
  Capabilities capabilities() const override { return {.gradient = true}; }

 private:
  /// Throws InvalidInput where a reaction is missing or x_c is not free.
  std::unique_ptr<const ObjectiveFunction> do_bind(const CalibrationData& data,
                                                   const ParameterSet& parameters) const override;

  Options options_;
};

}  // namespace modcal
