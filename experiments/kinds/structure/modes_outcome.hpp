// What kind fit_modes tells of its modes.
#pragma once

#include "experiments/kinds/structure/structure_kinds.hpp"
#include "experiments/report/result.hpp"
#include "libinverse/structure/strikes/strike_fit.hpp"

namespace modcal {

struct ModesOutcome {
  const StrikeFit& fit;
  const std::vector<std::string>& names;  ///< of the strikes
  double rest;  ///< of which the mean was taken [s]; NaN: response functions

  void visit(ResultVisitor& visitor) const;

 private:
  void visit_strikes(ResultVisitor& visitor) const;
};

/// How many modes, and what the model leaves of the responses.
std::string sentence_of(const StrikeFit& fit, const FitModesOptions& options);

}  // namespace modcal
