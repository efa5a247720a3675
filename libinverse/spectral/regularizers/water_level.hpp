#pragma once

#include "libinverse/spectral/regularizers/regularizer.hpp"

namespace modcal {

/// Water level that zeroes: F = R/H where |H| > ε, 0 elsewhere, that is φ = 1 where σ > ε, else 0
/// (Debut, Delaune and Antunes, 2010, eq. 15). The parameter is ε, in the unit of H [N/N].
class WaterLevel final : public Regularizer {
 public:
  struct Options {
    void visit(OptionVisitor& /*visitor*/) {}
  };
  explicit WaterLevel(const Options& /*options*/) {}

 private:
  void do_filter_factors(std::span<const double> sigma, double parameter, std::span<double> kept,
                         std::span<double> lost) const override;
  /// Cumulative sums over the sorted components: one pass for all parameters.
  void do_trace_squares(const SpectralSystem& system, std::span<const double> parameters,
                        std::span<CurvePoint> curve) const override;
};

}  // namespace modcal
