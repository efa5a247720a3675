#pragma once

#include "libinverse/spectral/regularizers/regularizer.hpp"

namespace modcal {

/// Direct inversion, φ = 1 wherever σ > 0 (Debut, Delaune and Antunes, 2010, eq. 10).
class NoRegularization final : public Regularizer {
 public:
  struct Options {
    void visit(OptionVisitor& /*visitor*/) {}
  };
  explicit NoRegularization(const Options& /*options*/) {}
  bool has_parameter() const override { return false; }

 private:
  void do_filter_factors(std::span<const double> sigma, double parameter, std::span<double> kept,
                         std::span<double> lost) const override;
};

}  // namespace modcal
