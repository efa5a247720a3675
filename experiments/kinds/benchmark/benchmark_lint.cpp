// Whether the methods of a benchmark have equal chances.

#include <set>

#include "experiments/kinds/benchmark/benchmark.hpp"

namespace modcal {
namespace {

// What differs between the tasks of one method, as texts.
struct MethodFacts {
  std::set<std::string> problems, replicates, budgets, ranges, starts, noise;
  std::size_t tasks = 0;
  CalibrateOptions first;
};

template <typename Section>
std::string text_of(Section section) {
  return fingerprint([&section](OptionVisitor& visitor) { section.visit(visitor); });
}

using Methods = std::map<std::string, MethodFacts>;

Methods facts_of(const std::vector<BenchmarkLabels>& tasks, const CellOptions& options_of) {
  Methods facts;
  for (std::size_t task = 0; task < tasks.size(); ++task) {
    const BenchmarkLabels& labels = tasks[task];
    const CalibrateOptions options = options_of(task);
    const auto [place, is_new] = facts.try_emplace(labels.method());
    MethodFacts& ours = place->second;
    if (is_new) ours.first = options;
    ++ours.tasks;
    ours.problems.insert(labels.condition + " / " + labels.replicate);
    ours.replicates.insert(labels.replicate);
    ours.budgets.insert(text_of(options.calibration.budget));
    ours.ranges.insert(text_of(options.calibration.parameters.ranges));
    ours.starts.insert(text_of(options.inversion.model_error));
    ours.noise.insert(text_of(options.inversion.observation.measurement));
  }
  return facts;
}

using Warnings = std::vector<Finding>;

void warn(Warnings& warnings, std::string path, std::string text) {
  warnings.push_back({std::move(path), std::move(text), false});
}

// The first method whose facts differ from those of the first one; null: none.
const std::string* odd_one(const Methods& methods, std::set<std::string> MethodFacts::*fact) {
  for (const auto& [name, facts] : methods) {
    if (facts.*fact != methods.begin()->second.*fact) return &name;
  }
  return nullptr;
}

void lint_problems(const Methods& methods, Warnings& warnings) {
  const std::string& first = methods.begin()->first;
  const auto compare = [&](const char* path, std::set<std::string> MethodFacts::*fact,
                           const char* differ) {
    const std::string* odd = odd_one(methods, fact);
    if (odd != nullptr) {
      warn(warnings, path, fmt::format("{} and {} have different {}", *odd, first, differ));
    }
  };
  compare("model_error", &MethodFacts::starts,
          "starts: errors of another size are another problem");
  compare("measurement", &MethodFacts::noise, "noise: more of it is another problem");
  compare("calibration.budget", &MethodFacts::budgets, "budgets: what costs more wins");
  compare("calibration.parameters", &MethodFacts::ranges,
          "bounds: the narrower range is a head start");
  const std::string* odd = odd_one(methods, &MethodFacts::problems);
  if (odd == nullptr) return;
  warn(warnings, "sweep",
       fmt::format("{} meets {} problems, {} meets {}: methods are compared on the problems "
                   "they share",
                   *odd, methods.at(*odd).problems.size(), first,
                   methods.begin()->second.problems.size()));
}

void lint_draws(const Methods& methods, Warnings& warnings) {
  constexpr std::size_t kEnough = 10;
  std::size_t fewest = kEnough;
  for (const auto& [name, facts] : methods) fewest = std::min(fewest, facts.replicates.size());
  if (methods.size() < 2 || fewest >= kEnough) return;
  warn(warnings, "sweep",
       fmt::format("{} draws a condition tell methods apart only where they differ "
                   "grossly: take {} seeds or more",
                   fewest, kEnough));
}

// ½ Σ (x_i − 1.1)²: no search has an easier task.
class Bowl final : public ObjectiveFunction {
 public:
  explicit Bowl(std::size_t dimension) : dimension_(dimension) {}
  std::string_view name() const override { return "bowl"; }
  std::size_t dimension() const override { return dimension_; }
  std::size_t residual_count() const override { return dimension_; }
  Capabilities capabilities() const override { return {.gradient = true, .least_squares = true}; }

 private:
  void do_evaluate(std::span<const double> x, const ObjectiveOutputs& outputs) const override {
    if (outputs.value) *outputs.value = 0.0;
    for (std::size_t i = 0; i < dimension_; ++i) {
      const double r = x[i] - 1.1;
      if (outputs.value) *outputs.value += 0.5 * r * r;
      if (outputs.gradient) outputs.gradient[i] = r;
      if (outputs.residuals) outputs.residuals[i] = r;
      for (std::size_t j = 0; outputs.jacobian && j < dimension_; ++j) {
        outputs.jacobian[i * dimension_ + j] = i == j ? 1.0 : 0.0;
      }
    }
  }
  std::size_t dimension_;
};

constexpr std::int64_t kMostEvaluations = 20000;  // of a bowl: a glance, not a study

enum class Ending { kFinished, kCut, kRefused };

// refusal: why it does not even begin, where it does not.
Ending ending_of(const Optimizer& optimizer, std::size_t dimension, Budget budget,
                 std::string* refusal = nullptr) {
  const std::vector<Variable> variables(
      dimension, {.name = "x", .initial = 0.7, .lower = 0.5, .upper = 1.7, .scale = 0.1});
  budget.target = std::numeric_limits<double>::quiet_NaN();
  budget.seconds = std::numeric_limits<double>::quiet_NaN();
  try {
    const OptimizationResult result = optimizer.minimize(Bowl(dimension), variables, budget);
    // With half of the way behind it the search did begin, whatever it still has to polish.
    const bool near = result.value <= 0.25 * result.initial_value;
    return result.stop == StopReason::kEvaluationBudget && !near ? Ending::kCut : Ending::kFinished;
  } catch (const InvalidInput& error) {
    if (refusal != nullptr) *refusal = error.what();
    return Ending::kRefused;
  }
}

std::size_t dimension_of(const CalibrateOptions& options) {
  const StringModel string = options.inversion.observation.string_model().before_reading();
  return options.calibration.parameters.names(static_cast<std::size_t>(string.modes)).size();
}

// Why no task of the method can have a result, whatever its data; empty: some may.
std::string impossible(const CalibrateOptions& options) {
  const CalibrationOptions& calibration = options.calibration;
  std::string refusal;
  try {
    const auto optimizer = calibration.optimizer.make();
    const auto objective = calibration.objective.make();
    refusal =
        optimizer->explain_unsatisfied(calibration.objective.selected(), objective->capabilities());
    // What needs more than a bowl has is not tried on one.
    const Bowl bowl(1);
    if (!refusal.empty() || !optimizer->explain_unsatisfied(bowl).empty()) return refusal;
    if (calibration.budget.evaluations > kMostEvaluations) return {};
    ending_of(*optimizer, dimension_of(options), calibration.budget, &refusal);
  } catch (const InvalidInput&) {
    return {};  // another finding says so
  }
  return refusal;
}

void lint_pairs(const Methods& methods, Warnings& warnings) {
  for (const auto& [name, facts] : methods) {
    const std::string reason = impossible(facts.first);
    if (reason.empty()) continue;
    warn(warnings, "sweep",
         fmt::format("{}: its {} tasks will all fail: {}; leave the pair out (sweep.exclude)", name,
                     facts.tasks, reason));
  }
}

// A search that gets to the bottom of a bowl, but nowhere near it within the budget.
bool is_cut_everywhere(const CalibrateOptions& options) {
  constexpr std::int64_t kMore = 20;
  if (options.calibration.by_schedule()) return false;
  Budget budget = options.calibration.budget;
  if (budget.evaluations > kMostEvaluations) return false;
  try {
    const std::size_t dimension = dimension_of(options);
    const auto optimizer = options.calibration.optimizer.make();
    if (ending_of(*optimizer, dimension, budget) != Ending::kCut) return false;
    budget.evaluations = std::min(kMore * budget.evaluations, kMostEvaluations);
    return ending_of(*optimizer, dimension, budget) == Ending::kFinished;
  } catch (const InvalidInput&) {
    return false;  // another finding says so
  }
}

}  // namespace

std::vector<Finding> lint_fairness(const std::vector<BenchmarkLabels>& tasks,
                                   const CellOptions& options_of) {
  const Methods methods = facts_of(tasks, options_of);
  Warnings warnings;
  if (methods.empty()) return {};
  lint_pairs(methods, warnings);
  lint_problems(methods, warnings);
  lint_draws(methods, warnings);
  std::map<std::string, bool> probed;  // what the answer depends on
  for (const auto& [name, facts] : methods) {
    CalibrationOptions calibration = facts.first.calibration;
    const std::string key = fingerprint([&](OptionVisitor& visitor) {
                              visitor("optimizer", "", calibration.optimizer);
                            }) +
                            text_of(calibration.budget) + text_of(calibration.parameters);
    const auto [place, is_new] = probed.try_emplace(key, false);
    if (!is_new) continue;
    if (is_cut_everywhere(facts.first)) {
      warn(warnings, "calibration.budget",
           fmt::format("{} does not come half the way to the minimum of a parabola within {} "
                       "evaluations: the budget cuts it everywhere",
                       name, facts.first.calibration.budget.evaluations));
    }
  }
  return warnings;
}

}  // namespace modcal
