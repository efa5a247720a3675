#include "libcalib/optimizers/nlopt_optimizer.hpp"

#include <nlopt.h>

#include <algorithm>
#include <array>
#include <memory>
#include <new>

#include "libsim/base/error.hpp"

namespace modcal {
namespace {

constexpr std::array<std::string_view, 26> kAlgorithms = {"GN_AGS",
                                                          "GN_CRS2_LM",
                                                          "GN_DIRECT",
                                                          "GN_DIRECT_L",
                                                          "GN_DIRECT_L_NOSCAL",
                                                          "GN_DIRECT_L_RAND",
                                                          "GN_DIRECT_L_RAND_NOSCAL",
                                                          "GN_DIRECT_NOSCAL",
                                                          "GN_ESCH",
                                                          "GN_ISRES",
                                                          "LD_CCSAQ",
                                                          "LD_LBFGS",
                                                          "LD_MMA",
                                                          "LD_SLSQP",
                                                          "LD_TNEWTON",
                                                          "LD_TNEWTON_PRECOND",
                                                          "LD_TNEWTON_PRECOND_RESTART",
                                                          "LD_TNEWTON_RESTART",
                                                          "LD_VAR1",
                                                          "LD_VAR2",
                                                          "LN_BOBYQA",
                                                          "LN_COBYLA",
                                                          "LN_NELDERMEAD",
                                                          "LN_NEWUOA_BOUND",
                                                          "LN_PRAXIS",
                                                          "LN_SBPLX"};

struct Destroy {
  void operator()(nlopt_opt_s* optimizer) const { nlopt_destroy(optimizer); }
};
using Handle = std::unique_ptr<nlopt_opt_s, Destroy>;

struct Callback {
  Evaluator& evaluator;
  nlopt_opt optimizer;
  double last_value = 0.0;
};

double evaluate(unsigned n, const double* z, double* gradient, void* data) {
  auto& callback = *static_cast<Callback*>(data);
  double value = 0.0;
  if (callback.evaluator.try_evaluate({z, n}, {.value = &value, .gradient = gradient})) {
    return callback.last_value = value;
  }
  nlopt_force_stop(callback.optimizer);
  // Some algorithms work on for a while: with an infinite value LN_NEWUOA_BOUND does so for
  // seconds.
  if (gradient) std::fill_n(gradient, n, 0.0);
  return callback.last_value;
}

void require_ok(nlopt_result result, nlopt_opt optimizer) {
  if (result >= 0) return;
  if (result == NLOPT_OUT_OF_MEMORY) throw std::bad_alloc();
  const char* text = nlopt_get_errmsg(optimizer);
  throw_invalid_input("NLopt's {} refuses {} variables: {}; choose another algorithm",
                      nlopt_algorithm_to_string(nlopt_get_algorithm(optimizer)),
                      nlopt_get_dimension(optimizer), text ? text : "it gives no reason");
}

StopReason reason_of(nlopt_result result, nlopt_opt optimizer) {
  switch (result) {
    case NLOPT_FTOL_REACHED:
      return StopReason::kSmallDecrease;
    case NLOPT_XTOL_REACHED:
      return StopReason::kSmallStep;
    case NLOPT_SUCCESS:
      return StopReason::kConverged;
    case NLOPT_ROUNDOFF_LIMITED:
      return StopReason::kRoundoff;
    case NLOPT_INVALID_ARGS:
    case NLOPT_OUT_OF_MEMORY:
      require_ok(result, optimizer);
      [[fallthrough]];
    default:
      return StopReason::kNoProgress;
  }
}

}  // namespace

std::span<const std::string_view> NloptOptimizer::algorithms() { return kAlgorithms; }

void NloptOptimizer::Options::visit(OptionVisitor& visitor) {
  const auto names = algorithms();
  visitor.text({.key = "algorithm",
                .meaning = "NLopt's name of the algorithm; GN and LN ones need no gradient",
                .choices = {names.begin(), names.end()}},
               algorithm);
  visitor.number({.key = "step_tolerance",
                  .meaning = "smallest step, relative to the range of the variables",
                  .unit = "1",
                  .range = Range::non_negative()},
                 step_tolerance);
  visitor.number({.key = "value_tolerance",
                  .meaning = "smallest decrease, relative to the value",
                  .unit = "1",
                  .range = Range::non_negative()},
                 value_tolerance);
  visitor.number({.key = "initial_step",
                  .meaning = "first step, relative to the range of the variables",
                  .unit = "1",
                  .range = Range::positive()},
                 initial_step);
  visitor.integer({.key = "seed",
                   .meaning = "seed of the algorithms that draw random numbers",
                   .range = Range::at_least(0)},
                  seed);
}

NloptOptimizer::NloptOptimizer(const Options& options) : options_(options) {
  MODCAL_REQUIRE(
      std::find(kAlgorithms.begin(), kAlgorithms.end(), options.algorithm) != kAlgorithms.end(),
      "NLopt algorithm \"{}\" is unknown, or cannot minimize within bounds by itself; "
      "usable: {}",
      options.algorithm, fmt::join(kAlgorithms, ", "));
}

Capabilities NloptOptimizer::needs() const { return {.gradient = options_.algorithm[1] == 'D'}; }

StopReason NloptOptimizer::search(Evaluator& evaluator) const {
  const auto n = static_cast<unsigned>(evaluator.dimension());
  const nlopt_algorithm algorithm = nlopt_algorithm_from_string(options_.algorithm.c_str());
  const Handle handle(nlopt_create(algorithm, n));
  if (!handle) throw std::bad_alloc();
  nlopt_opt optimizer = handle.get();
  Callback callback{evaluator, optimizer};
  require_ok(nlopt_set_min_objective(optimizer, evaluate, &callback), optimizer);
  require_ok(nlopt_set_lower_bounds(optimizer, evaluator.lower().data()), optimizer);
  require_ok(nlopt_set_upper_bounds(optimizer, evaluator.upper().data()), optimizer);
  require_ok(nlopt_set_xtol_abs1(optimizer, options_.step_tolerance), optimizer);
  require_ok(nlopt_set_ftol_rel(optimizer, options_.value_tolerance), optimizer);
  require_ok(nlopt_set_initial_step1(optimizer, options_.initial_step), optimizer);
  // The generator belongs to the thread and is seeded from the clock by default.
  nlopt_srand(static_cast<unsigned long>(options_.seed));
  std::vector<double> z = evaluator.start();
  double value = 0.0;
  return reason_of(nlopt_optimize(optimizer, z.data(), &value), optimizer);
}

}  // namespace modcal
