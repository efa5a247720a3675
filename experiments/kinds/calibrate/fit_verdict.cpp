#include "experiments/kinds/calibrate/fit_verdict.hpp"

#include <fmt/core.h>

namespace modcal {

std::string contradiction(const ContinuationResult& found) {
  std::string text;
  if (!found.fits) {
    text = fmt::format("the fit is wrong: reduced chi2 {:.4f}, where {:.4f} would scatter from 1",
                       found.chi2, found.chi2_deviation);
  }
  if (!found.priors.contradicted()) return text;
  if (!text.empty()) text += "; ";
  return text +
         fmt::format("the data contradict the priors stated, that of {} most ({:.3g} deviations)",
                     found.priors.farthest, found.priors.deviations);
}

}  // namespace modcal
