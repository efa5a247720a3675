#pragma once

#include "libinverse/spectral/regularizers/regularizer.hpp"

namespace modcal {

/// Water level that clips: |H| is raised to ε where it lies below and keeps its phase, that is
/// φ = min(1, σ/ε) (Clayton and Wiggins, 1976, as seismology uses the term since). The parameter is
/// ε, in the unit of H [N/N]. Where H = 0 there is no phase to keep: φ = 0.
class WaterLevelClip final : public Regularizer {
 public:
  struct Options {
    void visit(OptionVisitor& /*visitor*/) {}
  };
  explicit WaterLevelClip(const Options& /*options*/) {}

 private:
  void do_filter_factors(std::span<const double> sigma, double parameter, std::span<double> kept,
                         std::span<double> lost) const override;
  /// Cumulative sums over the sorted components: one pass for all parameters.
  void do_trace_squares(const SpectralSystem& system, std::span<const double> parameters,
                        std::span<CurvePoint> curve) const override;
};

}  // namespace modcal
