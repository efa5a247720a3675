#include "libcalib/optimizers/nlopt_optimizer.hpp"

#include <fmt/ranges.h>
#include <nlopt.h>

#include <algorithm>
#include <memory>
#include <new>
#include <vector>

#include "libcalib/optimizers/nlopt_algorithms.hpp"
#include "libcalib/optimizers/unbounded_search.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

const std::vector<std::string_view>& usable_names() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> usable;
    for (const NloptAlgorithm& row : nlopt_algorithms()) {
      if (row.use != NloptUse::kRefused) usable.push_back(row.name);
    }
    return usable;
  }();
  return names;
}

// Algorithms that another may start.
const std::vector<std::string_view>& local_choices() {
  static const std::vector<std::string_view> names = [] {
    std::vector<std::string_view> local = {"automatic"};
    for (const NloptAlgorithm& row : nlopt_algorithms()) {
      if (row.use == NloptUse::kInTheBox && row.name[0] == 'L') local.push_back(row.name);
    }
    return local;
  }();
  return names;
}

struct Destroy {
  void operator()(nlopt_opt_s* optimizer) const { nlopt_destroy(optimizer); }
};
using Handle = std::unique_ptr<nlopt_opt_s, Destroy>;

struct Callback {
  Evaluator& evaluator;
  UnboundedSearch* unbounded;  // null: the algorithm keeps to the bounds
  nlopt_opt optimizer;
  double last_value = 0.0;
};

double evaluate(unsigned n, const double* z, double* gradient, void* data) {
  auto& callback = *static_cast<Callback*>(data);
  double value = 0.0;
  const ObjectiveOutputs outputs{.value = &value, .gradient = gradient};
  const auto trial = callback.unbounded ? callback.unbounded->try_evaluate({z, n}, outputs)
                                        : callback.evaluator.try_evaluate({z, n}, outputs);
  if (trial != Evaluator::Trial::kOver) return callback.last_value = value;
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

Handle create(const std::string& algorithm, unsigned variables) {
  Handle handle(nlopt_create(nlopt_algorithm_from_string(algorithm.c_str()), variables));
  if (!handle) throw std::bad_alloc();
  return handle;
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

std::span<const std::string_view> NloptOptimizer::algorithms() { return usable_names(); }

void NloptOptimizer::Options::visit(OptionVisitor& visitor) {
  visitor.text({.key = "algorithm",
                .meaning = "NLopt's name of the algorithm; GN and LN ones need no gradient",
                .choices = usable_names()},
               algorithm);
  visitor.text({.key = "local_algorithm",
                .meaning = "what MLSL starts from many points; automatic: LN_BOBYQA or LD_LBFGS",
                .choices = local_choices()},
               local_algorithm);
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
  const NloptAlgorithm* row = find_nlopt_algorithm(options.algorithm);
  MODCAL_REQUIRE(row != nullptr, "NLopt has no algorithm \"{}\"; usable: {}", options.algorithm,
                 fmt::join(usable_names(), ", "));
  MODCAL_REQUIRE(row->use != NloptUse::kRefused, "NLopt's {} is refused: {}", row->name,
                 row->refusal);
  if (options.local_algorithm == "automatic") return;
  const auto& local = local_choices();
  MODCAL_REQUIRE(std::find(local.begin(), local.end(), options.local_algorithm) != local.end(),
                 "\"{}\" is no local algorithm; usable: {}", options.local_algorithm,
                 fmt::join(local, ", "));
  MODCAL_REQUIRE(row->use == NloptUse::kTwoLevels,
                 "NLopt's {} starts no local algorithm: leave local_algorithm out", row->name);
  MODCAL_REQUIRE(row->needs_gradient() || options.local_algorithm[1] == 'N',
                 "NLopt's {} has no gradient for {}: take GD_MLSL or GD_MLSL_LDS, or a local "
                 "algorithm without",
                 row->name, options.local_algorithm);
}

Capabilities NloptOptimizer::needs() const {
  return {.gradient = find_nlopt_algorithm(options_.algorithm)->needs_gradient()};
}

void NloptOptimizer::set_tolerances(nlopt_opt_s* optimizer) const {
  require_ok(nlopt_set_xtol_abs1(optimizer, options_.step_tolerance), optimizer);
  require_ok(nlopt_set_ftol_rel(optimizer, options_.value_tolerance), optimizer);
  require_ok(nlopt_set_initial_step1(optimizer, options_.initial_step), optimizer);
}

void NloptOptimizer::set_local_algorithm(nlopt_opt_s* optimizer) const {
  const bool gradient = find_nlopt_algorithm(options_.algorithm)->needs_gradient();
  const std::string name = options_.local_algorithm != "automatic" ? options_.local_algorithm
                           : gradient                              ? "LD_LBFGS"
                                                                   : "LN_BOBYQA";
  const Handle local = create(name, nlopt_get_dimension(optimizer));
  set_tolerances(local.get());
  require_ok(nlopt_set_local_optimizer(optimizer, local.get()), optimizer);  // takes a copy
}

StopReason NloptOptimizer::search(Evaluator& evaluator) const {
  const NloptUse use = find_nlopt_algorithm(options_.algorithm)->use;
  const Handle handle = create(options_.algorithm, static_cast<unsigned>(evaluator.dimension()));
  nlopt_opt optimizer = handle.get();
  UnboundedSearch unbounded(evaluator);
  Callback callback{evaluator, use == NloptUse::kUnbounded ? &unbounded : nullptr, optimizer};
  require_ok(nlopt_set_min_objective(optimizer, evaluate, &callback), optimizer);
  if (use != NloptUse::kUnbounded) {
    require_ok(nlopt_set_lower_bounds(optimizer, evaluator.lower().data()), optimizer);
    require_ok(nlopt_set_upper_bounds(optimizer, evaluator.upper().data()), optimizer);
  }
  set_tolerances(optimizer);
  if (use == NloptUse::kTwoLevels) set_local_algorithm(optimizer);
  // The generator belongs to the thread and is seeded from the clock by default.
  nlopt_srand(static_cast<unsigned long>(options_.seed));
  std::vector<double> z = evaluator.start();
  double value = 0.0;
  return reason_of(nlopt_optimize(optimizer, z.data(), &value), optimizer);
}

}  // namespace modcal
