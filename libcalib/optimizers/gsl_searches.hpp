// The families of algorithms of the GNU Scientific Library, one file each.
#pragma once

#include "libcalib/optimizers/gsl_optimizer.hpp"
#include "libcalib/optimizers/unbounded_search.hpp"

namespace modcal {

StopReason gsl_simplex(UnboundedSearch& search, const GslOptimizer::Options& options);
StopReason gsl_descent(UnboundedSearch& search, const GslOptimizer::Options& options);
StopReason gsl_least_squares(UnboundedSearch& search, const GslOptimizer::Options& options);
StopReason gsl_line(UnboundedSearch& search, const GslOptimizer::Options& options);

}  // namespace modcal
