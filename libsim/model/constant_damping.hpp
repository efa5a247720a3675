#pragma once

#include "libsim/model/damping.hpp"

namespace modcal {

/// One damping ratio for all modes, ζ_n = ζ (Debut, Delaune and Antunes, 2010, section 2.3).
class ConstantDamping final : public DampingLaw {
 public:
  struct Options {
    double ratio = 1e-3;  ///< ζ [1]
    void visit(OptionVisitor& visitor);
  };
  explicit ConstantDamping(const Options& options) : options_(options) {}

 private:
  double ratio(const DampedMode& mode) const override;
  Options options_;
};

}  // namespace modcal
