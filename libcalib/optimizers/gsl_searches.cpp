#include "libcalib/optimizers/gsl_searches.hpp"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_math.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <new>
#include <numbers>
#include <utility>

#include "libcalib/optimizers/tolerances.hpp"
#include "libcalib/optimizers/tuning.hpp"

namespace modcal {
namespace {

/// Owns what an allocating function of the library returned; its error handler being off, a null
/// pointer says that memory ran out.
template <typename Object>
std::shared_ptr<Object> owned(Object* object, void (*release)(Object*)) {
  if (object == nullptr) throw std::bad_alloc();
  return {object, release};
}

std::shared_ptr<gsl_vector> vector_of(std::size_t size, double value) {
  auto vector = owned(gsl_vector_alloc(size), gsl_vector_free);
  gsl_vector_set_all(vector.get(), value);
  return vector;
}

/// The search as the library's functions see it, with the best point, which the library forgets
/// where a line search fails.
struct Values {
  UnboundedSearch& search;
  std::shared_ptr<gsl_vector> best = vector_of(search.dimension(), 0.0);
  double best_value = std::numeric_limits<double>::infinity();

  double at(const gsl_vector* u, double* gradient = nullptr) {
    double value = 0.0;
    const ObjectiveOutputs outputs{.value = &value, .gradient = gradient};
    if (search.try_evaluate({u->data, u->size}, outputs) == Evaluator::Trial::kOver) {
      return GSL_NAN;
    }
    if (value < best_value) {
      best_value = value;
      gsl_vector_memcpy(best.get(), u);
    }
    return value;
  }
};

double value_at(const gsl_vector* u, void* values) { return static_cast<Values*>(values)->at(u); }

void both_at(const gsl_vector* u, void* values, double* value, gsl_vector* gradient) {
  gsl_vector_set_zero(gradient);
  *value = static_cast<Values*>(values)->at(u, gradient->data);
}

void gradient_at(const gsl_vector* u, void* values, gsl_vector* gradient) {
  double value = 0.0;
  both_at(u, values, &value, gradient);
}

double value_on_line(double u, void* values) {
  const auto point = gsl_vector_const_view_array(&u, 1);
  return value_at(&point.vector, values);
}

/// Decides when iterations of a descent no longer pay.
class Progress {
 public:
  Progress(const gsl_multimin_fdfminimizer* minimizer, const GslOptimizer::Options& options)
      : minimizer_(minimizer),
        options_(options),
        decreases_(options.value_tolerance),
        value_(minimizer->f) {}

  bool slope_vanishes() const {
    return gsl_blas_dnrm2(minimizer_->gradient) <= options_.gradient_tolerance;
  }
  /// The reason to end after an iteration; kNotRun: go on.
  StopReason after_iteration() {
    if (slope_vanishes()) return StopReason::kConverged;
    const double step = gsl_blas_dnrm2(minimizer_->dx);
    const double size = gsl_blas_dnrm2(minimizer_->x);
    if (step > 0.0 && step <= options_.step_tolerance * (size + options_.step_tolerance)) {
      return StopReason::kSmallStep;
    }
    const double decrease = std::exchange(value_, minimizer_->f) - minimizer_->f;
    return decreases_.are_small(decrease, value_) ? StopReason::kSmallDecrease
                                                  : StopReason::kNotRun;
  }

 private:
  const gsl_multimin_fdfminimizer* minimizer_;
  const GslOptimizer::Options& options_;
  SmallDecreases decreases_;
  double value_;
};

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

double half_square(const gsl_multifit_nlinear_workspace& workspace) {
  const gsl_vector* r = gsl_multifit_nlinear_residual(&workspace);
  double sum = 0.0;
  for (std::size_t j = 0; j < r->size; ++j) sum += 0.5 * r->data[j] * r->data[j];
  return sum;
}

/// Three points with the lowest value in the middle.
struct Bracket {
  double a = 0.0, b = 0.0, c = 0.0;
  double fa = 0.0, fb = 0.0, fc = 0.0;
  bool valid() const { return fb < fa && fb < fc; }
};

// Downhill in steps that grow by the golden ratio. The map into the box turns back at its bounds,
// so that a function that falls up to a bound has its minimum there and a bracket around it.
Bracket bracket_from(Values& values, double step) {
  const auto value = [&values](double u) { return value_on_line(u, &values); };
  Bracket found{.a = 0.0, .b = step, .fa = value(0.0), .fb = value(step)};
  if (found.fb > found.fa) {
    std::swap(found.a, found.b);
    std::swap(found.fa, found.fb);
  }
  for (int tries = 0; tries < 100 && !values.search.stopped(); ++tries) {
    found.c = found.b + std::numbers::phi * (found.b - found.a);
    found.fc = value(found.c);
    if (found.fc > found.fb) break;
    found.a = std::exchange(found.b, found.c);
    found.fa = std::exchange(found.fb, found.fc);
  }
  if (found.a > found.c) {
    std::swap(found.a, found.c);
    std::swap(found.fa, found.fc);
  }
  return found;
}

}  // namespace

StopReason gsl_search(const GslSimplex* type, UnboundedSearch& search,
                      const GslOptimizer::Options& options) {
  const std::size_t n = search.dimension();
  Values values{search};
  gsl_multimin_function function{value_at, n, &values};
  const auto minimizer =
      owned(gsl_multimin_fminimizer_alloc(type, n), gsl_multimin_fminimizer_free);
  int status = gsl_multimin_fminimizer_set(minimizer.get(), &function, vector_of(n, 0.0).get(),
                                           vector_of(n, options.initial_step).get());
  while (status == GSL_SUCCESS && !search.stopped()) {
    status = gsl_multimin_fminimizer_iterate(minimizer.get());
    const double size = gsl_multimin_fminimizer_size(minimizer.get());
    if (gsl_multimin_test_size(size, options.step_tolerance) == GSL_SUCCESS) {
      return StopReason::kSmallStep;
    }
  }
  return StopReason::kNoProgress;
}

StopReason gsl_search(const GslDescent* type, UnboundedSearch& search,
                      const GslOptimizer::Options& options) {
  const std::size_t n = search.dimension();
  Values values{search};
  gsl_multimin_function_fdf function{value_at, gradient_at, both_at, n, &values};
  const auto minimizer =
      owned(gsl_multimin_fdfminimizer_alloc(type, n), gsl_multimin_fdfminimizer_free);
  const auto start_at_the_best = [&] {
    const auto start = vector_of(n, 0.0);
    gsl_vector_memcpy(start.get(), values.best.get());
    gsl_multimin_fdfminimizer_set(minimizer.get(), &function, start.get(), options.initial_step,
                                  kGslLineTolerance);
  };
  start_at_the_best();
  Progress progress(minimizer.get(), options);
  bool restarted = false;
  while (!search.stopped()) {
    const double before = minimizer->f;
    const int status = gsl_multimin_fdfminimizer_iterate(minimizer.get());
    if (search.stopped()) break;
    // A line search that fails may have found better points, which the library drops.
    const bool better = values.best_value < std::min(before, minimizer->f);
    if (status == GSL_SUCCESS && !better) {
      const StopReason reason = progress.after_iteration();
      if (reason != StopReason::kNotRun) return reason;
      if (minimizer->f < before) restarted = false;
      continue;
    }
    if (progress.slope_vanishes()) return StopReason::kConverged;
    // A direction built up over many steps may lead nowhere: the gradient itself is tried once.
    if ((status != GSL_SUCCESS && status != GSL_ENOPROG) || (restarted && !better)) {
      return StopReason::kRoundoff;
    }
    start_at_the_best();
    restarted = true;
  }
  return StopReason::kNoProgress;
}

StopReason gsl_search(const GslTrustRegion* type, UnboundedSearch& search,
                      const GslOptimizer::Options& options) {
  const std::size_t n = search.dimension();
  gsl_multifit_nlinear_fdf function{};
  function.f = residuals_at;
  function.df = jacobian_at;
  function.n = search.residual_count();
  function.p = n;
  function.params = &search;
  gsl_multifit_nlinear_parameters parameters = gsl_multifit_nlinear_default_parameters();
  parameters.trs = type;
  const auto workspace =
      owned(gsl_multifit_nlinear_alloc(gsl_multifit_nlinear_trust, &parameters, function.n, n),
            gsl_multifit_nlinear_free);
  int status = gsl_multifit_nlinear_init(vector_of(n, 0.0).get(), &function, workspace.get());
  SmallDecreases decreases(options.value_tolerance);
  while (status == GSL_SUCCESS && !search.stopped()) {
    const double before = half_square(*workspace);
    status = gsl_multifit_nlinear_iterate(workspace.get());
    if (search.stopped()) break;
    int info = 0;
    const int test = gsl_multifit_nlinear_test(options.step_tolerance, options.gradient_tolerance,
                                               0.0, &info, workspace.get());
    // Where no step helps any more: the optimum to rounding if the gradient says so.
    if (test == GSL_SUCCESS && info != 1) return StopReason::kConverged;
    if (status != GSL_SUCCESS) break;
    if (test == GSL_SUCCESS) return StopReason::kSmallStep;
    const double after = half_square(*workspace);
    if (decreases.are_small(before - after, after)) return StopReason::kSmallDecrease;
  }
  return status == GSL_ENOPROG ? StopReason::kRoundoff : StopReason::kNoProgress;
}

StopReason gsl_search(const GslLine* type, UnboundedSearch& search,
                      const GslOptimizer::Options& options) {
  Values values{search};
  const Bracket bracket = bracket_from(values, options.initial_step);
  if (search.stopped() || !bracket.valid()) return StopReason::kNoProgress;
  gsl_function function{value_on_line, &values};
  const auto minimizer = owned(gsl_min_fminimizer_alloc(type), gsl_min_fminimizer_free);
  int status = gsl_min_fminimizer_set_with_values(minimizer.get(), &function, bracket.b, bracket.fb,
                                                  bracket.a, bracket.fa, bracket.c, bracket.fc);
  int resting = 0;
  while (status == GSL_SUCCESS && !search.stopped()) {
    const double before = gsl_min_fminimizer_x_minimum(minimizer.get());
    status = gsl_min_fminimizer_iterate(minimizer.get());
    const double at = gsl_min_fminimizer_x_minimum(minimizer.get());
    const double width =
        gsl_min_fminimizer_x_upper(minimizer.get()) - gsl_min_fminimizer_x_lower(minimizer.get());
    resting = std::abs(at - before) <= options.step_tolerance ? resting + 1 : 0;
    if (width <= options.step_tolerance || resting >= kRestingSteps) return StopReason::kSmallStep;
  }
  return search.stopped() ? StopReason::kNoProgress : StopReason::kRoundoff;
}

}  // namespace modcal
