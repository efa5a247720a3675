// What a benchmark says in plain language.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "experiments/kinds/benchmark/benchmark_report.hpp"

namespace modcal {
namespace {

constexpr std::size_t kMostNames = 4;

std::string listed(std::vector<std::string> names) {
  const std::size_t all = names.size();
  if (all <= kMostNames + 1) return fmt::format("{}", fmt::join(names, "; "));
  names.resize(kMostNames);
  return fmt::format("{}; {} more", fmt::join(names, "; "), all - kMostNames);
}

std::string recommended(const BenchmarkGrid& grid, const BenchmarkCell& cell) {
  const std::string bound = std::isfinite(cell.bound_ratio)
                                ? fmt::format(", RMSE {:.3g} times the bound", cell.bound_ratio)
                                : std::string();
  return fmt::format("{} (median error {:.2g}{}, {} of {} right, {:.0f} evaluations)",
                     grid.methods[cell.method], cell.error.median, bound, cell.successes, cell.n,
                     cell.evaluations);
}

// The methods that nothing is better than, and the cheapest of them.
std::string best_of(const BenchmarkGrid& grid, const std::vector<const BenchmarkCell*>& order) {
  std::vector<const BenchmarkCell*> best;
  for (const BenchmarkCell* cell : order) {
    if (cell->rank == 1 && cell->successes > 0) best.push_back(cell);
  }
  if (best.empty()) {
    const auto* clearest = *std::max_element(
        order.begin(), order.end(),
        [](const auto* a, const auto* b) { return a->reason_count < b->reason_count; });
    return fmt::format("no method is right; on {} of {} draws {} {}", clearest->reason_count,
                       clearest->n, grid.methods[clearest->method], clearest->reason);
  }
  const auto cheapest = std::min_element(
      best.begin(), best.end(),
      [](const auto* a, const auto* b) { return a->evaluations < b->evaluations; });
  std::string text = "use " + recommended(grid, **cheapest);
  std::vector<std::string> others;
  for (const BenchmarkCell* cell : best) {
    if (cell != *cheapest) others.push_back(grid.methods[cell->method]);
  }
  if (!others.empty()) {
    text += fmt::format("; not to be told apart from it: {}", listed(std::move(others)));
  }
  return text;
}

// "noise 1 %, 2 %, 5 %": what all begin with is said once.
std::string conditions_text(const std::vector<std::string>& conditions) {
  const std::string& first = conditions.front();
  const std::string prefix = first.substr(0, first.find(' ') + 1);
  std::string text = first;
  for (std::size_t i = 1; i < conditions.size(); ++i) {
    const bool same = !prefix.empty() && conditions[i].starts_with(prefix) &&
                      first.find(',') == std::string::npos;
    text += ", " + (same ? conditions[i].substr(prefix.size()) : conditions[i]);
  }
  return text;
}

// Cells of some methods whose draws are mostly wrong, told together.
struct Failures {
  std::size_t n = 0, wrong = 0;
  std::vector<std::string> conditions;
  std::map<std::string, std::size_t> reasons;

  void add(const BenchmarkGrid& grid, const BenchmarkCell& cell) {
    n += cell.n;
    wrong += cell.n - cell.successes;
    reasons[cell.reason] += cell.reason_count;
    const std::string& condition = grid.conditions[cell.condition];
    if (place_in(conditions, condition) == conditions.size()) conditions.push_back(condition);
  }
  std::string sentence(const BenchmarkGrid& grid, const std::string& who) const {
    const auto [reason, count] =
        *std::max_element(reasons.begin(), reasons.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; });
    const std::string where = conditions.size() == grid.conditions.size() && conditions.size() > 1
                                  ? "all conditions"
                                  : conditions_text(conditions);
    return fmt::format("{} fails on {} of {} draws at {}; {} {}.", who, wrong, n, where,
                       count == wrong ? "it" : fmt::format("on {} it", count), reason);
  }
};

bool is_failing(const BenchmarkCell& cell) { return cell.success.high < 0.5; }

bool fails_everywhere(const std::vector<BenchmarkCell>& cells, std::size_t method) {
  return std::all_of(cells.begin(), cells.end(), [method](const BenchmarkCell& cell) {
    return cell.method != method || is_failing(cell);
  });
}

Failures failures_of(const BenchmarkGrid& grid, const std::vector<BenchmarkCell>& cells,
                     const std::vector<std::size_t>& methods) {
  Failures failures;
  for (const BenchmarkCell& cell : cells) {
    const bool ours = std::find(methods.begin(), methods.end(), cell.method) != methods.end();
    if (ours && is_failing(cell)) failures.add(grid, cell);
  }
  return failures;
}

}  // namespace

std::vector<std::string> conclusion(const BenchmarkGrid& grid,
                                    const std::vector<BenchmarkCell>& cells) {
  std::vector<std::string> sentences;
  for (std::size_t condition = 0; condition < grid.conditions.size(); ++condition) {
    const auto order = ranked_cells(cells, condition);
    if (order.empty()) continue;
    sentences.push_back(
        fmt::format("At {}: {}.", grid.conditions[condition], best_of(grid, order)));
  }
  for (const std::string& objective : distinct(grid.objectives)) {
    std::vector<std::size_t> methods;
    for (std::size_t method = 0; method < grid.methods.size(); ++method) {
      if (grid.objectives[method] == objective) methods.push_back(method);
    }
    // An objective that no optimizer gets right is one finding, not one an optimizer.
    const bool together =
        methods.size() > 1 && std::all_of(methods.begin(), methods.end(), [&](std::size_t method) {
          return fails_everywhere(cells, method);
        });
    if (together) {
      const Failures failures = failures_of(grid, cells, methods);
      if (failures.n > 0) {
        sentences.push_back(failures.sentence(grid, objective + " with every optimizer"));
      }
      continue;
    }
    for (const std::size_t method : methods) {
      const Failures failures = failures_of(grid, cells, {method});
      if (failures.n > 0) sentences.push_back(failures.sentence(grid, grid.methods[method]));
    }
  }
  return sentences;
}

}  // namespace modcal
