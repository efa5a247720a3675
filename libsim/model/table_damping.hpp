#pragma once

#include <vector>

#include "libsim/model/damping.hpp"

namespace modcal {

/// Damping ratio linear in the frequency between tabulated points (f_j [Hz], ζ_j [1]), constant
/// outside them.
class TableDamping final : public DampingLaw {
 public:
  struct Options {
    std::vector<double> frequencies;  ///< f_j [Hz], strictly rising
    std::vector<double> ratios;       ///< ζ_j [1], as many
    void visit(OptionVisitor& visitor);
  };
  /// Throws InvalidInput where the two do not pair up or the frequencies do not rise.
  explicit TableDamping(Options options);

 private:
  double ratio(const DampedMode& mode) const override;
  Options options_;
};

}  // namespace modcal
