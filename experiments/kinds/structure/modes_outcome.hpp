// What kind fit_modes tells of its modes.
#pragma once

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

}  // namespace modcal
