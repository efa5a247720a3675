#include <gsl/gsl_errno.h>
#include <gsl/gsl_math.h>
#include <gsl/gsl_min.h>

#include <cmath>
#include <utility>

#include "libcalib/optimizers/gsl_handles.hpp"
#include "libcalib/optimizers/gsl_searches.hpp"

namespace modcal {
namespace {

using Minimizer = GslHandle<gsl_min_fminimizer, gsl_min_fminimizer_free>;

double value_at(double u, void* data) {
  double value = 0.0;
  auto& search = *static_cast<UnboundedSearch*>(data);
  const auto trial = search.try_evaluate({&u, 1}, {.value = &value});
  return trial == Evaluator::Trial::kOver ? GSL_NAN : value;
}

/// Three points with the lowest value in the middle.
struct Bracket {
  double a = 0.0, b = 0.0, c = 0.0;
  double fa = 0.0, fb = 0.0, fc = 0.0;
  bool valid() const { return fb < fa && fb < fc; }
};

// Downhill in steps that grow by the golden ratio. The map into the box turns back at its bounds,
// so that a function that falls up to a bound has its minimum there and a bracket around it.
Bracket bracket_from(UnboundedSearch& search, double step) {
  const auto value = [&search](double u) { return value_at(u, &search); };
  Bracket found{.a = 0.0, .b = step, .fa = value(0.0), .fb = value(step)};
  if (found.fb > found.fa) {
    std::swap(found.a, found.b);
    std::swap(found.fa, found.fb);
  }
  constexpr double kGolden = 1.618033988749895;
  for (int tries = 0; tries < 100 && !search.stopped(); ++tries) {
    found.c = found.b + kGolden * (found.b - found.a);
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

const gsl_min_fminimizer_type* type_of(std::string_view algorithm) {
  if (algorithm == "golden_section") return gsl_min_fminimizer_goldensection;
  if (algorithm == "quad_golden") return gsl_min_fminimizer_quad_golden;
  return gsl_min_fminimizer_brent;
}

}  // namespace

StopReason gsl_line(UnboundedSearch& search, const GslOptimizer::Options& options) {
  const Bracket bracket = bracket_from(search, options.initial_step);
  if (search.stopped() || !bracket.valid()) return StopReason::kNoProgress;
  gsl_function function{value_at, &search};
  const auto minimizer = gsl_owned<Minimizer>(gsl_min_fminimizer_alloc(type_of(options.algorithm)));
  int status = gsl_min_fminimizer_set_with_values(minimizer.get(), &function, bracket.b, bracket.fb,
                                                  bracket.a, bracket.fa, bracket.c, bracket.fc);
  // Near a minimum values differ by less than rounding within √ε of it: the bracket may stay wide.
  constexpr int kRest = 12;
  int resting = 0;
  while (status == GSL_SUCCESS && !search.stopped()) {
    const double before = gsl_min_fminimizer_x_minimum(minimizer.get());
    status = gsl_min_fminimizer_iterate(minimizer.get());
    const double at = gsl_min_fminimizer_x_minimum(minimizer.get());
    const double width =
        gsl_min_fminimizer_x_upper(minimizer.get()) - gsl_min_fminimizer_x_lower(minimizer.get());
    resting = std::abs(at - before) <= options.step_tolerance ? resting + 1 : 0;
    if (width <= options.step_tolerance || resting >= kRest) return StopReason::kSmallStep;
  }
  return search.stopped() ? StopReason::kNoProgress : StopReason::kRoundoff;
}

}  // namespace modcal
