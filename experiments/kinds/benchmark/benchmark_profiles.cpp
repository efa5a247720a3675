// Data profile, performance profile and waterfall of a benchmark.

#include "experiments/kinds/benchmark/benchmark.hpp"

namespace modcal {
namespace {

using report::SeriesStyle;

// Points of a curve: enough for the eye, few enough for a page of 2 MB.
constexpr std::size_t kMostShown = 100;
constexpr std::size_t kMostHidden = 24;

// Room above 1, where the best curves run.
constexpr std::array<double, 2> kShares = {0.0, 1.05};

bool belongs(const BenchmarkTask& task, std::size_t method, std::size_t condition) {
  return task.method == method && (condition == kAllConditions || task.condition == condition);
}

using ValueOf = std::function<std::optional<double>(const BenchmarkTask&)>;

struct Values {
  std::vector<std::pair<double, std::int64_t>> known;  ///< rising, with the tasks they come from
  std::size_t all = 0;                                 ///< tasks, with and without a value
};

Values values_of(const BenchmarkGrid& grid, std::size_t method, std::size_t condition,
                 const ValueOf& value_of) {
  Values values;
  for (const BenchmarkTask& task : grid.tasks) {
    if (!belongs(task, method, condition)) continue;
    ++values.all;
    if (const auto value = value_of(task)) {
      values.known.emplace_back(*value, static_cast<std::int64_t>(task.task));
    }
  }
  std::sort(values.known.begin(), values.known.end());
  return values;
}

// How a series is drawn through the rising values: add(series, share before, share after, value).
using AddValue = std::function<void(report::Series&, double before, double after,
                                    const std::pair<double, std::int64_t>& value)>;

report::Figure profile(const BenchmarkGrid& grid, report::Figure figure, const report::Axis& x,
                       const report::Axis& y, const ValueOf& value_of, const AddValue& add) {
  const auto add_method = [&](std::size_t method, report::Panel& panel) {
    for (const std::size_t condition : condition_choices(grid)) {
      const Values values = values_of(grid, method, condition, value_of);
      report::Series series = method_series(grid, method, condition, SeriesStyle::kLine);
      const std::size_t most = series.hidden ? kMostHidden : kMostShown;
      double before = 0.0;
      for (const std::size_t i : spread_indices(values.known.size(), most)) {
        const double after = static_cast<double>(i + 1) / static_cast<double>(values.all);
        add(series, before, after, values.known[i]);
        before = after;
      }
      add_drawn(panel, std::move(series));
    }
  };
  return panel_figure(std::move(figure), objective_panels(grid, x, y, add_method));
}

// Share of all tasks that each value brings, as a step.
void add_step(report::Series& series, double before, double after,
              const std::pair<double, std::int64_t>& value) {
  add_task(series, value.first, before, value.second);
  add_task(series, value.first, after, value.second);
}

using ProblemKey = std::pair<std::size_t, std::string>;  // condition and replicate

std::map<ProblemKey, double> fewest_evaluations(const BenchmarkGrid& grid) {
  std::map<ProblemKey, double> fewest;
  for (const BenchmarkTask& task : grid.tasks) {
    if (!task.outcome.success) continue;
    const auto spent = static_cast<double>(task.outcome.evaluations);
    const auto [known, is_new] = fewest.try_emplace({task.condition, task.replicate}, spent);
    if (!is_new) known->second = std::min(known->second, spent);
  }
  return fewest;
}

}  // namespace

report::Figure data_profile(const BenchmarkGrid& grid) {
  return profile(
      grid,
      {.id = "data_profile",
       .title = "Tasks solved against evaluations",
       .caption = fmt::format("Data profile over {} a method and condition. Solved: right by the "
                              "truth, when the search ended.",
                              draws_text(grid))},
      {.label = "evaluations", .logarithmic = true},
      {.label = "share of tasks solved", .range = kShares},
      [](const BenchmarkTask& task) -> std::optional<double> {
        if (!task.outcome.success) return std::nullopt;
        return static_cast<double>(task.outcome.evaluations);
      },
      add_step);
}

report::Figure performance_profile(const BenchmarkGrid& grid) {
  const std::map<ProblemKey, double> fewest = fewest_evaluations(grid);
  return profile(
      grid,
      {.id = "performance_profile",
       .title = "Problems solved against the fastest method",
       .caption = fmt::format(
           "Performance profile over {} a method and condition: the method with the fewest "
           "evaluations among all objectives and optimizers that solve the problem stands at 1.",
           draws_text(grid))},
      {.label = "evaluations / those of the fastest method", .logarithmic = true},
      {.label = "share of problems solved", .range = kShares},
      [&fewest](const BenchmarkTask& task) -> std::optional<double> {
        if (!task.outcome.success) return std::nullopt;
        return static_cast<double>(task.outcome.evaluations) /
               fewest.at({task.condition, task.replicate});
      },
      add_step);
}

report::Figure waterfall_figure(const BenchmarkGrid& grid) {
  return profile(
      grid,
      {.id = "waterfall",
       .title = "Errors of all starts, in rising order",
       .caption = fmt::format(
           "Waterfall of {} a method and condition: every seed is another wrong start and another "
           "noise. A step: so many starts end in one minimum.",
           draws_text(grid))},
      {.label = "share of starts", .range = kShares},
      {.label = "relative frequency error", .logarithmic = true},
      [](const BenchmarkTask& task) -> std::optional<double> {
        if (!(task.outcome.frequency_error > 0.0)) return std::nullopt;
        return task.outcome.frequency_error;
      },
      [](report::Series& series, double before, double after,
         const std::pair<double, std::int64_t>& value) {
        add_task(series, before, value.first, value.second);
        add_task(series, after, value.first, value.second);
      });
}

}  // namespace modcal
