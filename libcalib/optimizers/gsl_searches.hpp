// The families of searches of the GNU Scientific Library, told apart by the type of their tables.
#pragma once

#include <gsl/gsl_min.h>
#include <gsl/gsl_multifit_nlinear.h>
#include <gsl/gsl_multimin.h>

#include "libcalib/optimizers/gsl_optimizer.hpp"
#include "libcalib/optimizers/unbounded_search.hpp"

namespace modcal {

using GslSimplex = gsl_multimin_fminimizer_type;
using GslDescent = gsl_multimin_fdfminimizer_type;
using GslTrustRegion = gsl_multifit_nlinear_trs;
using GslLine = gsl_min_fminimizer_type;

StopReason gsl_search(const GslSimplex*, UnboundedSearch&, const GslOptimizer::Options&);
StopReason gsl_search(const GslDescent*, UnboundedSearch&, const GslOptimizer::Options&);
StopReason gsl_search(const GslTrustRegion*, UnboundedSearch&, const GslOptimizer::Options&);
StopReason gsl_search(const GslLine*, UnboundedSearch&, const GslOptimizer::Options&);

}  // namespace modcal
