#include "libcalib/parameters/prior_misfit.hpp"

#include <gsl/gsl_cdf.h>

namespace modcal {

bool PriorMisfit::contradicted() const {
  // Not "above": a misfit that is no number is no agreement either.
  return count > 0 && !(chi2 < gsl_cdf_chisq_Pinv(0.9973, static_cast<double>(count)));
}

}  // namespace modcal
