#include <gsl/gsl_errno.h>
#include <gsl/gsl_math.h>
#include <gsl/gsl_multimin.h>

#include "libcalib/optimizers/gsl_handles.hpp"
#include "libcalib/optimizers/gsl_searches.hpp"

namespace modcal {
namespace {

using Minimizer = GslHandle<gsl_multimin_fminimizer, gsl_multimin_fminimizer_free>;

double value_at(const gsl_vector* u, void* data) {
  double value = 0.0;
  auto& search = *static_cast<UnboundedSearch*>(data);
  const auto trial = search.try_evaluate({u->data, u->size}, {.value = &value});
  return trial == Evaluator::Trial::kOver ? GSL_NAN : value;
}

const gsl_multimin_fminimizer_type* type_of(std::string_view algorithm) {
  if (algorithm == "nmsimplex") return gsl_multimin_fminimizer_nmsimplex;
  if (algorithm == "nmsimplex2rand") return gsl_multimin_fminimizer_nmsimplex2rand;
  return gsl_multimin_fminimizer_nmsimplex2;
}

}  // namespace

StopReason gsl_simplex(UnboundedSearch& search, const GslOptimizer::Options& options) {
  const std::size_t n = search.dimension();
  gsl_multimin_function function{value_at, n, &search};
  const GslVector start = gsl_vector_of(n, 0.0);
  const GslVector step = gsl_vector_of(n, options.initial_step);
  const auto minimizer =
      gsl_owned<Minimizer>(gsl_multimin_fminimizer_alloc(type_of(options.algorithm), n));
  int status = gsl_multimin_fminimizer_set(minimizer.get(), &function, start.get(), step.get());
  while (status == GSL_SUCCESS && !search.stopped()) {
    status = gsl_multimin_fminimizer_iterate(minimizer.get());
    const double size = gsl_multimin_fminimizer_size(minimizer.get());
    if (gsl_multimin_test_size(size, options.step_tolerance) == GSL_SUCCESS) {
      return StopReason::kSmallStep;
    }
  }
  return StopReason::kNoProgress;
}

}  // namespace modcal
