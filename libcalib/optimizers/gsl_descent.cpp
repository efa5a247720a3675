#include <gsl/gsl_blas.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_math.h>
#include <gsl/gsl_multimin.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libcalib/optimizers/gsl_handles.hpp"
#include "libcalib/optimizers/gsl_searches.hpp"

namespace modcal {
namespace {

using Minimizer = GslHandle<gsl_multimin_fdfminimizer, gsl_multimin_fdfminimizer_free>;

/// The search with the best point met, which the library forgets where a line search fails.
struct Descent {
  UnboundedSearch& search;
  double best_value = std::numeric_limits<double>::infinity();
  GslVector best;

  double value_at(const gsl_vector* u, double* gradient) {
    double value = 0.0;
    const auto trial =
        search.try_evaluate({u->data, u->size}, {.value = &value, .gradient = gradient});
    if (trial == Evaluator::Trial::kOver) return GSL_NAN;
    if (value < best_value) {
      best_value = value;
      gsl_vector_memcpy(best.get(), u);
    }
    return value;
  }
};

void both_at(const gsl_vector* u, void* data, double* value, gsl_vector* gradient) {
  gsl_vector_set_zero(gradient);
  *value = static_cast<Descent*>(data)->value_at(u, gradient->data);
}

double value_at(const gsl_vector* u, void* data) {
  return static_cast<Descent*>(data)->value_at(u, nullptr);
}

void gradient_at(const gsl_vector* u, void* data, gsl_vector* gradient) {
  double value = 0.0;
  both_at(u, data, &value, gradient);
}

const gsl_multimin_fdfminimizer_type* type_of(std::string_view algorithm) {
  if (algorithm == "conjugate_fr") return gsl_multimin_fdfminimizer_conjugate_fr;
  if (algorithm == "conjugate_pr") return gsl_multimin_fdfminimizer_conjugate_pr;
  if (algorithm == "steepest_descent") return gsl_multimin_fdfminimizer_steepest_descent;
  if (algorithm == "vector_bfgs") return gsl_multimin_fdfminimizer_vector_bfgs;
  return gsl_multimin_fdfminimizer_vector_bfgs2;
}

/// Decides when iterations no longer pay.
class Progress {
 public:
  Progress(const gsl_multimin_fdfminimizer* minimizer, const GslOptimizer::Options& options)
      : minimizer_(minimizer), options_(options), value_(minimizer->f) {}

  /// The reason to end after an iteration; kNotRun: go on.
  StopReason after_iteration() {
    if (gsl_blas_dnrm2(minimizer_->gradient) <= options_.gradient_tolerance) {
      return StopReason::kConverged;
    }
    const double step = gsl_blas_dnrm2(minimizer_->dx);
    const double size = gsl_blas_dnrm2(minimizer_->x);
    if (step > 0.0 && step <= options_.step_tolerance * (size + options_.step_tolerance)) {
      return StopReason::kSmallStep;
    }
    const double decrease = value_ - minimizer_->f;
    value_ = minimizer_->f;
    // One short step along a bad direction says little; two in a row do.
    small_ = decrease <= options_.value_tolerance * std::abs(value_) ? small_ + 1 : 0;
    return small_ >= 2 ? StopReason::kSmallDecrease : StopReason::kNotRun;
  }

 private:
  const gsl_multimin_fdfminimizer* minimizer_;
  const GslOptimizer::Options& options_;
  double value_;
  int small_ = 0;
};

}  // namespace

StopReason gsl_descent(UnboundedSearch& search, const GslOptimizer::Options& options) {
  const std::size_t n = search.dimension();
  Descent descent{.search = search, .best = gsl_vector_of(n, 0.0)};
  gsl_multimin_function_fdf function{value_at, gradient_at, both_at, n, &descent};
  const auto minimizer =
      gsl_owned<Minimizer>(gsl_multimin_fdfminimizer_alloc(type_of(options.algorithm), n));
  // The manual's recommended accuracy of line searches.
  constexpr double kLineTolerance = 0.1;
  const auto start_at_the_best = [&] {
    const GslVector start = gsl_vector_of(n, 0.0);
    gsl_vector_memcpy(start.get(), descent.best.get());
    gsl_multimin_fdfminimizer_set(minimizer.get(), &function, start.get(), options.initial_step,
                                  kLineTolerance);
  };
  start_at_the_best();
  Progress progress(minimizer.get(), options);
  bool restarted = false;
  while (!search.stopped()) {
    const double before = minimizer->f;
    const int status = gsl_multimin_fdfminimizer_iterate(minimizer.get());
    if (search.stopped()) break;
    // A line search that fails may have found better points, which the library drops.
    const bool better = descent.best_value < std::min(before, minimizer->f);
    if (status == GSL_SUCCESS && !better) {
      const StopReason reason = progress.after_iteration();
      if (reason != StopReason::kNotRun) return reason;
      if (minimizer->f < before) restarted = false;
      continue;
    }
    if (gsl_blas_dnrm2(minimizer->gradient) <= options.gradient_tolerance) {
      return StopReason::kConverged;
    }
    // A direction built up over many steps may lead nowhere: the gradient itself is tried once.
    if ((status != GSL_SUCCESS && status != GSL_ENOPROG) || (restarted && !better)) {
      return StopReason::kRoundoff;
    }
    start_at_the_best();
    restarted = true;
  }
  return StopReason::kNoProgress;
}

}  // namespace modcal
