#include "libcalib/optimizers/nlopt_optimizer.hpp"

#include <fmt/ranges.h>
#include <nlopt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <new>
#include <numeric>
#include <utility>
#include <vector>

#include "libcalib/optimizers/tuning.hpp"
#include "libcalib/optimizers/unbounded_search.hpp"
#include "libsim/base/error.hpp"

namespace modcal {
namespace {

/// Algorithms whose name holds `part` and that are not simply run in the box: the first row counts.
struct Special {
  std::string_view part;
  NloptUse use;
  std::string_view refusal;
};
constexpr Special kSpecial[] = {
    {"AUGLAG", NloptUse::kRefused,
     "it serves constraints between variables; within bounds alone it only runs its local "
     "algorithm: choose that"},
    {"STOGO", NloptUse::kRefused,
     "nothing stops it before its own count of calls, so that a target, a time and an interrupt "
     "would be ignored; take GD_MLSL_LDS"},
    {"NOCEDAL", NloptUse::kRefused, "it is listed but not compiled; take LD_LBFGS"},
    {"ORIG_DIRECT", NloptUse::kRefused,
     "it crashes when it is stopped within its first points; take GN_DIRECT or GN_DIRECT_L"},
    {"G_MLSL", NloptUse::kRefused,
     "it leaves the local algorithm open; take GD_MLSL or GN_MLSL with local_algorithm"},
    {"MLSL", NloptUse::kTwoLevels, {}},
    {"NEWUOA_BOUND", NloptUse::kInTheBox, {}},
    {"NEWUOA", NloptUse::kUnbounded, {}},
    {"PRAXIS", NloptUse::kUnbounded, {}},
};

std::vector<NloptAlgorithm> list_algorithms() {
  std::vector<NloptAlgorithm> rows;
  for (int i = 0; i < NLOPT_NUM_ALGORITHMS; ++i) {
    NloptAlgorithm row{.name = nlopt_algorithm_to_string(static_cast<nlopt_algorithm>(i))};
    const auto* found = std::find_if(
        std::begin(kSpecial), std::end(kSpecial),
        [&](const Special& one) { return row.name.find(one.part) != std::string_view::npos; });
    if (found != std::end(kSpecial)) row = {row.name, found->use, found->refusal};
    rows.push_back(row);
  }
  std::sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return rows;
}

template <typename Test>
std::vector<std::string_view> names_where(Test test, std::vector<std::string_view> names = {}) {
  for (const NloptAlgorithm& row : NloptOptimizer::listed()) {
    if (test(row)) names.push_back(row.name);
  }
  return names;
}

// Algorithms that another may start, behind the word for the one that suits it.
const std::vector<std::string_view>& local_choices() {
  static const auto names = names_where(
      [](const auto& row) { return row.use == NloptUse::kInTheBox && row.name[0] == 'L'; },
      {"automatic"});
  return names;
}

using Handle = std::unique_ptr<nlopt_opt_s, decltype(&nlopt_destroy)>;

struct Callback {
  Evaluator& evaluator;
  UnboundedSearch* unbounded;  // null: the algorithm keeps to the bounds
  nlopt_opt optimizer;
  double best_value = std::numeric_limits<double>::infinity();
  std::vector<double> best;
  double unit = 1.0;  // of the values the algorithm sees
  bool choose_unit = false;
  double last_value = 0.0;
};

double evaluate(unsigned n, const double* z, double* gradient, void* data) {
  auto& callback = *static_cast<Callback*>(data);
  double value = 0.0;
  const ObjectiveOutputs outputs{.value = &value, .gradient = gradient};
  const auto trial = callback.unbounded ? callback.unbounded->try_evaluate({z, n}, outputs)
                                        : callback.evaluator.try_evaluate({z, n}, outputs);
  if (trial == Evaluator::Trial::kOver) {
    nlopt_force_stop(callback.optimizer);
    // Some algorithms work on for a while: with an infinite value LN_NEWUOA_BOUND does so for
    // seconds.
    if (gradient) std::fill_n(gradient, n, 0.0);
    return callback.last_value;
  }
  if (value < callback.best_value) {
    callback.best_value = value;
    callback.best.assign(z, z + n);
  }
  if (gradient) {
    const double slope = std::sqrt(std::inner_product(gradient, gradient + n, gradient, 0.0));
    if (std::exchange(callback.choose_unit, false) && slope > 0.0) callback.unit = slope;
    std::for_each_n(gradient, n, [&](double& entry) { entry /= callback.unit; });
  }
  return callback.last_value = value / callback.unit;
}

void require_ok(nlopt_result result, nlopt_opt optimizer) {
  if (result >= 0) return;
  if (result == NLOPT_OUT_OF_MEMORY) throw std::bad_alloc();
  const char* text = nlopt_get_errmsg(optimizer);
  throw_invalid_input("NLopt's {} refuses {} variables: {}; choose another algorithm",
                      nlopt_algorithm_to_string(nlopt_get_algorithm(optimizer)),
                      nlopt_get_dimension(optimizer), text ? text : "it gives no reason");
}

Handle create(const std::string& algorithm, unsigned variables,
              const NloptOptimizer::Options& options) {
  Handle handle(nlopt_create(nlopt_algorithm_from_string(algorithm.c_str()), variables),
                nlopt_destroy);
  if (!handle) throw std::bad_alloc();
  require_ok(nlopt_set_xtol_abs1(handle.get(), options.step_tolerance), handle.get());
  require_ok(nlopt_set_ftol_rel(handle.get(), options.value_tolerance), handle.get());
  require_ok(nlopt_set_initial_step1(handle.get(), options.initial_step), handle.get());
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

bool gave_up(StopReason reason) {
  return reason == StopReason::kNoProgress || reason == StopReason::kRoundoff;
}

// A quasi-Newton search whose model has gone wrong gives up or ends in small steps far from the
// optimum: as long as a fresh start gets on, the search is not over.
StopReason search_again_and_again(Callback& callback) {
  StopReason reason = StopReason::kNotRun;
  double before = std::numeric_limits<double>::infinity();
  while (true) {
    double value = 0.0;
    std::vector<double> z = callback.best;
    const StopReason fresh =
        reason_of(nlopt_optimize(callback.optimizer, z.data(), &value), callback.optimizer);
    // A fresh start that finds nothing better does not take back what the last one found.
    if (reason == StopReason::kNotRun || !gave_up(fresh)) reason = fresh;
    const bool better = callback.best_value < (1.0 - kFreshStartGain) * before;
    if (fresh == StopReason::kConverged || !better || callback.evaluator.stopped()) return reason;
    before = callback.best_value;
    callback.choose_unit = true;
  }
}

}  // namespace

std::span<const NloptAlgorithm> NloptOptimizer::listed() {
  static const std::vector<NloptAlgorithm> rows = list_algorithms();
  return rows;
}

std::span<const std::string_view> NloptOptimizer::algorithms() {
  static const auto names =
      names_where([](const auto& row) { return row.use != NloptUse::kRefused; });
  return names;
}

void NloptOptimizer::Options::visit(OptionVisitor& visitor) {
  visitor("algorithm", "NLopt's name of the algorithm; GN and LN ones need no gradient",
          {.choices = {algorithms().begin(), algorithms().end()}}, algorithm);
  visitor("local_algorithm", "what MLSL starts from many points; automatic: LN_BOBYQA or LD_LBFGS",
          {.choices = local_choices()}, local_algorithm);
  const auto number = [&visitor](std::string_view key, std::string_view meaning, Range range,
                                 double& value) { visitor(key, meaning, {.range = range}, value); };
  number("step_tolerance", "smallest step, relative to the range of the variables",
         Range::non_negative(), step_tolerance);
  number("value_tolerance", "smallest decrease, relative to the value", Range::non_negative(),
         value_tolerance);
  number("initial_step", "first step, relative to the range of the variables", Range::positive(),
         initial_step);
  visitor("seed", "seed of the algorithms that draw random numbers", {.range = Range::at_least(0)},
          seed);
}

NloptOptimizer::NloptOptimizer(const Options& options) : options_(options) {
  const auto rows = listed();
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const NloptAlgorithm& row) {
    return row.name == options.algorithm;
  });
  MODCAL_REQUIRE(found != rows.end(), "NLopt has no algorithm \"{}\"; usable: {}",
                 options.algorithm, fmt::join(algorithms(), ", "));
  row_ = &*found;
  MODCAL_REQUIRE(row_->use != NloptUse::kRefused, "NLopt's {} is refused: {}", row_->name,
                 row_->refusal);
  const auto& local = local_choices();
  const auto choice = std::find(local.begin(), local.end(), options.local_algorithm);
  if (choice == local.begin()) {  // automatic
    options_.local_algorithm = row_->needs_gradient() ? "LD_LBFGS" : "LN_BOBYQA";
    return;
  }
  MODCAL_REQUIRE(choice != local.end(), "\"{}\" is no local algorithm; usable: {}",
                 options.local_algorithm, fmt::join(local, ", "));
  MODCAL_REQUIRE(row_->use == NloptUse::kTwoLevels,
                 "NLopt's {} starts no local algorithm: leave local_algorithm out", row_->name);
  MODCAL_REQUIRE(row_->needs_gradient() || options.local_algorithm[1] == 'N',
                 "NLopt's {} has no gradient for {}: take GD_MLSL or GD_MLSL_LDS, or a local "
                 "algorithm without",
                 row_->name, options.local_algorithm);
}

Capabilities NloptOptimizer::needs() const { return {.gradient = row_->needs_gradient()}; }

StopReason NloptOptimizer::search(Evaluator& evaluator) const {
  const auto n = static_cast<unsigned>(evaluator.dimension());
  const Handle handle = create(options_.algorithm, n, options_);
  nlopt_opt optimizer = handle.get();
  UnboundedSearch unbounded(evaluator);
  const bool in_the_box = row_->use != NloptUse::kUnbounded;
  Callback callback{.evaluator = evaluator,
                    .unbounded = in_the_box ? nullptr : &unbounded,
                    .optimizer = optimizer,
                    .best = evaluator.start()};
  require_ok(nlopt_set_min_objective(optimizer, evaluate, &callback), optimizer);
  if (in_the_box) {
    require_ok(nlopt_set_lower_bounds(optimizer, evaluator.lower().data()), optimizer);
    require_ok(nlopt_set_upper_bounds(optimizer, evaluator.upper().data()), optimizer);
  }
  if (row_->use == NloptUse::kTwoLevels) {
    const Handle local = create(options_.local_algorithm, n, options_);
    require_ok(nlopt_set_local_optimizer(optimizer, local.get()), optimizer);  // takes a copy
  }
  // The generator belongs to the thread and is seeded from the clock by default.
  nlopt_srand(static_cast<unsigned long>(options_.seed));
  if (row_->name.starts_with("LD")) return search_again_and_again(callback);
  std::vector<double> z = evaluator.start();
  double value = 0.0;
  return reason_of(nlopt_optimize(optimizer, z.data(), &value), optimizer);
}

}  // namespace modcal
