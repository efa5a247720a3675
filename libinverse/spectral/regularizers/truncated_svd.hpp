#pragma once

#include "libinverse/spectral/regularizers/regularizer.hpp"

namespace modcal {

/// Truncated singular value decomposition: φ = 1 where σ ≥ λ, else 0 (Hansen, 1998, section 5.3).
/// The parameter is the smallest singular value kept; in a diagonal Fourier problem a water level
/// that keeps the bin at the level.
class TruncatedSvd final : public Regularizer {
 public:
  struct Options {
    void visit(OptionVisitor& /*visitor*/) {}
  };
  explicit TruncatedSvd(const Options& /*options*/) {}

 private:
  void do_filter_factors(std::span<const double> sigma, double parameter, std::span<double> kept,
                         std::span<double> lost) const override;
};

}  // namespace modcal
