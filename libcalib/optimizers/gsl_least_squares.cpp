#include <gsl/gsl_errno.h>
#include <gsl/gsl_multifit_nlinear.h>

#include <algorithm>
#include <cmath>

#include "libcalib/optimizers/gsl_handles.hpp"
#include "libcalib/optimizers/gsl_searches.hpp"

namespace modcal {
namespace {

using Workspace = GslHandle<gsl_multifit_nlinear_workspace, gsl_multifit_nlinear_free>;

int residuals_at(const gsl_vector* u, void* data, gsl_vector* residuals) {
  auto& search = *static_cast<UnboundedSearch*>(data);
  const auto trial = search.try_evaluate({u->data, u->size}, {.residuals = residuals->data});
  return trial == Evaluator::Trial::kOver ? GSL_EBADFUNC : GSL_SUCCESS;
}

// The library's matrices are row-major without gaps, like ours.
int jacobian_at(const gsl_vector* u, void* data, gsl_matrix* jacobian) {
  auto& search = *static_cast<UnboundedSearch*>(data);
  const auto trial = search.try_evaluate({u->data, u->size}, {.jacobian = jacobian->data});
  return trial == Evaluator::Trial::kFinite ? GSL_SUCCESS : GSL_EBADFUNC;
}

gsl_multifit_nlinear_parameters parameters_of(std::string_view algorithm) {
  gsl_multifit_nlinear_parameters parameters = gsl_multifit_nlinear_default_parameters();
  parameters.trs = gsl_multifit_nlinear_trs_lm;
  if (algorithm == "lmaccel") parameters.trs = gsl_multifit_nlinear_trs_lmaccel;
  if (algorithm == "dogleg") parameters.trs = gsl_multifit_nlinear_trs_dogleg;
  if (algorithm == "ddogleg") parameters.trs = gsl_multifit_nlinear_trs_ddogleg;
  if (algorithm == "subspace2d") parameters.trs = gsl_multifit_nlinear_trs_subspace2D;
  return parameters;
}

double half_square(const gsl_multifit_nlinear_workspace* workspace) {
  const gsl_vector* r = gsl_multifit_nlinear_residual(workspace);
  double sum = 0.0;
  for (std::size_t j = 0; j < r->size; ++j) sum += 0.5 * r->data[j] * r->data[j];
  return sum;
}

StopReason reason_after(const gsl_multifit_nlinear_workspace* workspace, double decrease,
                        const GslOptimizer::Options& options) {
  int info = 0;
  const int status = gsl_multifit_nlinear_test(options.step_tolerance, options.gradient_tolerance,
                                               0.0, &info, workspace);
  if (status == GSL_SUCCESS) return info == 1 ? StopReason::kSmallStep : StopReason::kConverged;
  const bool small = decrease <= options.value_tolerance * half_square(workspace);
  return small ? StopReason::kSmallDecrease : StopReason::kNotRun;
}

}  // namespace

StopReason gsl_least_squares(UnboundedSearch& search, const GslOptimizer::Options& options) {
  const std::size_t n = search.dimension();
  gsl_multifit_nlinear_fdf function{};
  function.f = residuals_at;
  function.df = jacobian_at;
  function.n = search.residual_count();
  function.p = n;
  function.params = &search;
  const gsl_multifit_nlinear_parameters parameters = parameters_of(options.algorithm);
  const auto workspace = gsl_owned<Workspace>(gsl_multifit_nlinear_alloc(
      gsl_multifit_nlinear_trust, &parameters, search.residual_count(), n));
  const GslVector start = gsl_vector_of(n, 0.0);
  int status = gsl_multifit_nlinear_init(start.get(), &function, workspace.get());
  while (status == GSL_SUCCESS && !search.stopped()) {
    const double before = half_square(workspace.get());
    status = gsl_multifit_nlinear_iterate(workspace.get());
    if (search.stopped()) break;
    const StopReason reason =
        reason_after(workspace.get(), before - half_square(workspace.get()), options);
    if (status == GSL_SUCCESS && reason != StopReason::kNotRun) return reason;
    // No step helps any more: the optimum to rounding where the gradient says so.
    if (reason == StopReason::kConverged) return reason;
  }
  return status == GSL_ENOPROG ? StopReason::kRoundoff : StopReason::kNoProgress;
}

}  // namespace modcal
